# SPDX-License-Identifier: Apache-2.0
import sys

from prospect.program import main

sys.exit(main())
