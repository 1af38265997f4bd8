# SPDX-License-Identifier: Apache-2.0
# What a type checker knows of the compiled module. A test compares it with the module.
import os
from typing import Any, Callable, Optional, Union

import numpy as np
from numpy.typing import ArrayLike

from prospect._core import Belief, Configuration, Plan, Registries

_Array = np.ndarray[Any, np.dtype[np.float64]]
_Cells = np.ndarray[Any, np.dtype[np.uint8]]

class Simulation:
    def __init__(
        self,
        world: Union[str, os.PathLike[str]] = "office",
        configuration: Optional[Configuration] = None,
        seed: int = 1,
    ) -> None: ...
    def reset(self, seed: int = 1) -> None: ...
    def belief(self) -> Belief: ...
    def apply(self, command: ArrayLike, duration: float) -> None: ...
    def drive(self, plan: Plan) -> str: ...
    @property
    def time(self) -> float: ...
    @property
    def true_pose(self) -> _Array: ...  # (4,)
    @property
    def estimated_pose(self) -> _Array: ...  # (4,)
    @property
    def localization_error(self) -> float: ...
    @property
    def coverage(self) -> float: ...
    @property
    def seen_area(self) -> float: ...
    @property
    def path_length(self) -> float: ...
    @property
    def collisions(self) -> int: ...
    @property
    def losses(self) -> int: ...
    @property
    def true_ground(self) -> tuple[_Cells, tuple[float, float, float, float]]: ...  # (ny, nx)
    @property
    def configuration(self) -> Configuration: ...

def read_log(path: Union[str, os.PathLike[str]]) -> dict[str, Any]: ...
def run_program(
    arguments: list[str],
    run_file: Callable[[str, Registries], None],
    program: list[str],
) -> int: ...
