import sys

from prospect.program import main

sys.exit(main())
