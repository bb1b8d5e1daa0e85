"""The table of hostile input: what is handed to the program, and what it has to answer."""

from tests.hostile.cases_of_files import FILES, MATRICES, OUTPUTS, PLUGINS
from tests.hostile.cases_of_json import JSON, NUMBERS, OVERRIDES, QUERIES
from tests.hostile.cases_of_scenes import MESHES, SCENE_CASES
from tests.hostile.cases_of_sweeps import SWEEPS

CASES = [*FILES, *JSON, *OVERRIDES, *NUMBERS, *SWEEPS, *MESHES, *SCENE_CASES, *PLUGINS, *QUERIES, *MATRICES, *OUTPUTS]
