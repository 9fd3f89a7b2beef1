"""A system as a functional mock-up unit: run by another program, FMPy, against our own run of the same motion."""

import math

import numpy as np
import pytest
from commands import wirerope
from free_bodies import free_block
from house import sdof

import wirerope_mj as wr
from wirerope_mj.engine.simulation.stepwise import Stepwise
from wirerope_mj.foundation.errors import RecordError, SimulationError
from wirerope_mj.foundation.resources import models_folder
from wirerope_mj.motions.motion import BaseMotion

pytest.importorskip("pythonfmu3")
fmpy = pytest.importorskip("fmpy")
validation = pytest.importorskip("fmpy.validation")

from wirerope_mj.runs.fmu import write_fmu  # noqa: E402

HOLD = 1e-3
STEP = 2.5e-4


class Held(BaseMotion):
    """A base whose acceleration is held over equal times, as an importer holds the inputs of a unit."""

    kind = "held"

    def __init__(self, accelerations):
        self.rows = np.asarray(accelerations, dtype=float)
        self.duration = HOLD * len(self.rows)
        zero = np.zeros((1, 3))
        self.rates = np.concatenate([zero, HOLD * np.cumsum(self.rows, axis=0)])
        moved = HOLD * self.rates[:-1] + 0.5 * HOLD**2 * self.rows
        self.moved = np.concatenate([zero, np.cumsum(moved, axis=0)])

    def _derivative(self, t, order):
        row = np.clip(np.floor(t / HOLD + 1e-6).astype(int), 0, len(self.rows) - 1)
        since = (t - HOLD * row)[:, np.newaxis]
        a, v, x = self.rows[row], self.rates[row], self.moved[row]
        return (x + v * since + 0.5 * a * since**2, v + a * since, a)[order]

    corners = property(lambda self: HOLD * np.arange(len(self.rows) + 1))
    description = property(lambda self: "held")
    events = property(lambda self: ())
    shortest_time = property(lambda self: math.inf)
    directions = property(lambda self: np.array([[0.0, 0.0, 1.0]]))

    def _parameters(self, files):
        return {}


def shaken(n):
    """Return accelerations along z, (n, 3): a half-sine of 15 g and 11 ms, sampled, then rest."""
    time = HOLD * np.arange(n)
    pulse = np.where(time < 0.011, np.sin(math.pi * time / 0.011), 0.0)
    return 15.0 * wr.STANDARD_GRAVITY * pulse[:, np.newaxis] * [0.0, 0.0, 1.0]


def largest_difference(one, other):
    return float(np.abs(one - other).max() / np.abs(other).max())


@pytest.fixture(scope="module")
def table():
    return wr.load_system(models_folder() / "shock_table.xml")


@pytest.fixture(scope="module")
def unit(table, tmp_path_factory):
    return write_fmu(table, tmp_path_factory.mktemp("unit") / "table.fmu", timestep=STEP)


def test_fmpy_runs_the_unit_as_we_run_the_system(table, unit):
    assert validation.validate_fmu(str(unit)) == []
    n = 150
    rows = shaken(n)
    expected = wr.simulate(table, Held(rows), duration=n * HOLD, timestep=STEP, sample_rate=1.0 / HOLD, engine="mujoco")
    inputs = np.array(
        [(HOLD * k, rows[min(k, n - 1), 2]) for k in range(n + 1)],
        dtype=[("time", float), ("base.acceleration.z", float)],
    )
    outputs = [
        "bodies.block.acceleration.z",
        "bodies.block.position.z",
        "mounts.m1.deflection.axial",
        "mounts.m1.force.axial",
    ]
    result = fmpy.simulate_fmu(
        str(unit),
        stop_time=n * HOLD,
        step_size=HOLD,
        output_interval=HOLD,
        input=inputs,
        output=outputs,
        use_event_mode=False,
    )
    np.testing.assert_allclose(result["time"], expected.time, atol=1e-12)
    block, m1 = expected.bodies["block"], expected.mounts["m1"]
    ours = block.acceleration[:, 2], block.position[:, 2], m1.deflection[:, 2], m1.force[:, 2]
    for name, values in zip(outputs, ours, strict=True):
        # Two orders of summation: 1.2e-9 since the mount has a second scale of friction, below 1e-9 before.
        assert largest_difference(result[name], values) < 2e-9, name


def test_loads_that_are_held_are_those_of_a_table():
    system, wrench = free_block(), [300.0, -200.0, 100.0, 20.0, -30.0, 40.0]
    table = wr.ForceTable(site="engine", times=[0.0, 0.2], loads=[wrench, wrench])
    expected = wr.simulate(system, table, duration=0.1, timestep=STEP, sample_rate=1.0 / HOLD, engine="mujoco")
    going = Stepwise(system, timestep=STEP)
    names = going.plan.names[going.plan.first_sensor :]
    rows = [going.values]
    for _ in range(100):
        going.advance(HOLD, np.zeros(3), {"engine": wrench})
        rows.append(going.values)
    for name in ("bodies/block/position/x", "bodies/block/orientation/w", "mounts/m2/force/shear"):
        ours = np.array(rows)[:, names.index(name)]
        assert largest_difference(ours, expected.column(name)) < 1e-9, name


def test_the_length_between_two_instants_changes_nothing_but_the_steps(table):
    fine, coarse = (Stepwise(table, timestep=STEP) for _ in range(2))
    for _ in range(100):
        fine.advance(HOLD, [0.0, 0.0, 2.0])
    coarse.advance(100 * HOLD, [0.0, 0.0, 2.0])  # more steps than one table of the callback holds
    assert coarse.time == pytest.approx(fine.time, abs=1e-12)
    assert largest_difference(coarse.values, fine.values) < 1e-9


def test_a_unit_does_not_go_back_by_itself_and_a_run_that_fails_is_an_error_of_the_unit(unit, tmp_path):
    from wirerope_mj.runs.fmu_slave import WireRopeUnit

    folder = fmpy.extract(str(unit), str(tmp_path / "there"))
    slave = WireRopeUnit(instance_name="unit", resources=f"{folder}/resources")
    slave.exit_initialization_mode()
    assert slave.do_step(0.0, HOLD).status == 0
    assert slave.do_step(0.0, HOLD).status != 0
    assert "only a state that it gave before" in slave.log_queue[-1].msg
    slave._base[2] = 1e12  # nothing bears that
    assert slave.do_step(HOLD, 100 * HOLD).status != 0
    assert "MuJoCo reported" in slave.log_queue[-1].msg


def test_a_unit_begins_at_any_time_steps_by_any_length_and_returns_to_its_states_bit_by_bit(unit, tmp_path):
    description = fmpy.read_model_description(str(unit))
    can = description.coSimulation
    assert (can.canHandleVariableCommunicationStepSize, can.canGetAndSetFMUstate, can.canSerializeFMUstate) == (True,) * 3
    at = {variable.name: variable.valueReference for variable in description.modelVariables}
    folder = fmpy.extract(str(unit), str(tmp_path / "there"))

    def begun(start):
        slave = fmpy.fmi3.FMU3Slave(
            guid=description.guid, unzipDirectory=folder, modelIdentifier=can.modelIdentifier, instanceName="unit"
        )
        slave.instantiate()
        slave.enterInitializationMode(startTime=start)
        slave.exitInitializationMode()
        return slave

    def read(slave):
        block = ("bodies.block.acceleration.z", "bodies.block.position.z")
        names = (*block, "mounts.m1.force.axial", "base.acceleration.z", "time")
        return slave.getFloat64([at[name] for name in names])

    def shake(slave, begin):
        """Advance by steps of three lengths under an acceleration, and read all."""
        slave.setFloat64([at["base.acceleration.z"]], [60.0])
        for since, step in ((0.0, 1e-3), (1e-3, 3.7e-3), (4.7e-3, 0.4e-3)):
            slave.doStep(begin + since, step)
        return read(slave)

    early, late = begun(0.0), begun(2.0)
    at_rest = read(early)
    rest = early.getFMUState()
    first, shifted = shake(early, 0.0), shake(late, 2.0)
    assert first[0] > 1.0  # m/s^2: it was shaken
    # Nothing depends on time but the clock, whose steps at 2 s are rounded at 4e-16 s, 4e-13 of a step of 1 ms.
    assert shifted[:4] == pytest.approx(first[:4], rel=1e-10)
    assert shifted[4] - first[4] == pytest.approx(2.0, abs=1e-12)
    early.setFMUState(rest)
    assert read(early) == at_rest
    assert shake(early, 0.0) == first
    saved = early.serializeFMUState(early.getFMUState())
    early.setFloat64([at["base.acceleration.z"]], [1e12])  # nothing bears that
    with pytest.raises(fmpy.fmi1.FMICallException):
        early.doStep(first[4], 0.1)
    early.setFMUState(early.deserializeFMUState(saved))
    assert read(early) == first
    early.doStep(first[4], 1e-3)


def test_a_law_that_ends_is_said_where_it_ends():
    short = wr.Tabulated(deflection=[-0.01, 0.0, 0.01], force=[-1e3, 0.0, 1e3])
    going = Stepwise(sdof(short), timestep=STEP, initial="unloaded")
    with pytest.raises(SimulationError, match=r"mount 'm1' was at .* whose law holds up to 0.01 m, .* at 0\.01 s"):
        going.advance(0.01, [0.0, 0.0, 1000.0])


@pytest.mark.slow
def test_the_command_writes_a_unit_once_and_names_what_is_wrong(tmp_path):
    assert wirerope("fmu", "shock_table", "table.fmu", cwd=tmp_path).returncode == 0
    description = fmpy.read_model_description(str(tmp_path / "table.fmu"))
    units = {variable.name: variable.unit for variable in description.modelVariables}
    assert description.fmiVersion == "3.0"
    assert units["mounts.m1.force.axial"] == "N"
    assert units["base.acceleration.z"] == "m/s^2"
    again = wirerope("fmu", "shock_table", "table.fmu", cwd=tmp_path)
    assert (again.returncode, "the file exists" in again.stderr) == (2, True)
    for out, said in (("table.zip", "ends in .fmu"), ("nowhere/table.fmu", "no folder")):
        with pytest.raises(RecordError, match=said):
            write_fmu(wr.load_system("shock_table"), tmp_path / out)
    with pytest.raises(SimulationError, match="RK4 is stable up to"):
        write_fmu(wr.load_system("shock_table"), tmp_path / "coarse.fmu", timestep=0.1)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["table.fmu"]
