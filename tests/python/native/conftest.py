"""Runs the tests of snow on both engines."""

import pytest
from snow_fall import ENGINE

ON_BOTH_ENGINES = {
    "test_snow",
    "test_snow_alpha",
    "test_snow_dust",
    "test_snow_melt",
    "test_snow_persistence",
    "test_snow_place",
    "test_snow_replace",
    "test_snow_shading",
    "test_snow_sides",
    "test_snow_simulation",
    "test_snow_state",
}


def pytest_generate_tests(metafunc):
    if metafunc.module.__name__.rpartition(".")[2] in ON_BOTH_ENGINES:
        metafunc.fixturenames.append("engine")
        metafunc.parametrize("engine", ["CPU", "GL"], indirect=True)


@pytest.fixture
def engine(request):
    """Sets the engine of the test's simulations that name none."""
    before = ENGINE.set(request.param)
    yield request.param
    ENGINE.reset(before)
