"""Tests of what snow does run on both engines."""

import pytest
import snowbough_native as native

ON_BOTH_ENGINES = {
    "test_snow",
    "test_snow_alpha",
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
def engine(request, monkeypatch):
    """Simulations of the test have this engine where they ask for none."""
    make = native.SnowSimulation
    monkeypatch.setattr(
        native,
        "SnowSimulation",
        lambda *args, **settings: make(*args, **{"engine": request.param, **settings}),
    )
    return request.param
