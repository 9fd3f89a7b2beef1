"""Programs that call the public API go on working: names, parameters, kinds and defaults change only by adding."""

import inspect

import pytest

import wirerope_mj as wr
from wirerope_mj.cli.app import COMMANDS

pytestmark = pytest.mark.quick

# Where a default is `...` there is one, whatever its value.
CALLS = """
BoucWen(*, alpha, beta, gamma, n, k=0.0)
Ozdemir(*, alpha, beta, n, k=0.0)
EnhancedDryFriction(*, k, d, u_c)
AsymmetricBoucWen(*, alpha, beta, gamma, n, k1, k2, k3, b, c)
SymmetricBoucWen(*, alpha, beta, gamma, n, k1, k2, k3)
Masing(*, stiffness, slip_force, k=0.0)
TinkerCutchins(*, k1, k2=0.0, k3=0.0, c=0.0, n=1.0, f0=0.0, f1=0.0, f2=0.0, smoothing)
EquivalentViscous(*, k1, k2=0.0, k3=0.0, energy, amplitude, frequency)
VaianaRosati(*, kb, f0, alpha, b1=0.0, b2=0.0, g1=0.0, g2=0.0, g3=0.0)
KelvinVoigt(*, k, c)
Zener(*, k0, k1, c)
BoucWen.trace(self, deflection, *, time=None)
cyclic_test(law, amplitudes, *, operating_point=0.0, frequency=1.0, cycles=None, points_per_cycle=400)
read_cyclic_test(path)
Isolator(*, name, roll=None, shear=None, axial=None, coupling=None, limits=..., geometry=None, provenance=..., spread=None)
Isolator.save(self, path)
load_isolator(path)
load_system(source, *, isolators=None)
HalfSine(*, peak, duration, direction, start=0.0)
Sawtooth(*, peak, duration, direction, start=0.0)
Trapezoid(*, peak, duration, rise, direction, start=0.0)
VelocityStep(*, velocity, direction, start=0.0)
DoubleHalfSine(*, peak, velocity, displacement, direction, start=0.0)
Sweep(*, start, stop, rate, acceleration=None, direction)
Sine(*, frequency, acceleration, direction)
RandomVibration(*, psd, duration, seed, direction)
load_record(path, *, channels=None, scale=1.0, baseline="none", start=0.0)
HalfSine.acceleration(self, time)
HalfSine.velocity(self, time)
HalfSine.displacement(self, time)
equilibrium(system, *, history="virgin")
simulate(system, motion, *, duration, initial=None, timestep=None, accuracy=1e-4, sample_rate=1000.0, callback="native",
    out=None, progress=False)
Response.save(self, folder)
load_response(folder)
record_rerun(response, path)
identify(loops, *, law=AsymmetricBoucWen, scales=1, extra_residuals=())
modes(system, *, history="virgin")
frequency_sweep(system, sweep, *, payload, response_direction=None)
periodic_orbit(system, *, frequency, acceleration, direction)
follow_branch(system, *, start, stop, acceleration=None, direction, payload, response_direction=None)
shock_response_spectrum(time, acceleration, frequencies=None, *, q=10.0)
load_measured(path, *, channels)
correlate(response, measured)
calibrate(system, tests, *, vary)
load_job(path)
run_job(job, folder)
load_flexible(path)
Scenario(question, model, motion, simulate)
run_scenario(scenario, folder)
""".replace("\n    ", " ").split("\n")[1:-1]

RESULTS = {
    "Loop": "deflection force hysteretic_state dissipated_energy secant_stiffness damping_ratio cycles closure",
    "System": "model mounts payloads",
    "HalfSine": "duration corners",
    "Equilibrium": "mounts state residual",
    "Response": "time base bodies points mounts peaks scene final_state timestep",
    "Peak": "value time vector",
    "Identification": "law parameters residual converged message",
    "Modes": "frequencies shapes",
    "FrequencySweep": "frequency amplitude",
    "PeriodicOrbit": "response floquet_multipliers stable residual",
    "Branch": "frequency amplitude stable folds",
    "ShockResponseSpectrum": "frequencies maximax positive negative primary residual pseudo_velocity",
    "Correlation": "table statement",
    "Calibration": "values covariance samples system message",
}


@pytest.mark.parametrize("call", CALLS, ids=lambda call: call.partition("(")[0])
def test_what_was_callable_is_called_as_before(call):
    name, _, parameters = call.partition("(")
    now = wr
    for part in name.split("."):
        now = getattr(now, part)
    stable = inspect.signature(eval(f"lambda {parameters[:-1]}: 0", {"AsymmetricBoucWen": wr.AsymmetricBoucWen}))
    today = inspect.signature(now).parameters
    for parameter in stable.parameters.values():
        assert today[parameter.name].kind is parameter.kind, parameter
        if parameter.default is ...:
            assert today[parameter.name].default is not inspect.Parameter.empty, parameter
        else:
            assert today[parameter.name].default == parameter.default, parameter
    for added in today.keys() - stable.parameters.keys():
        assert today[added].default is not inspect.Parameter.empty, added
    places = [one.name for one in today.values() if one.kind is not one.KEYWORD_ONLY]
    stated = [one.name for one in stable.parameters.values() if one.kind is not one.KEYWORD_ONLY]
    assert places[: len(stated)] == stated


@pytest.mark.parametrize("name", RESULTS)
def test_results_have_what_they_had(name):
    kind = getattr(wr, name)
    fields = {*dir(kind), *getattr(kind, "__dataclass_fields__", ())}
    assert not set(RESULTS[name].split()) - fields


def test_commands_have_the_names_they_had():
    had = (
        "new run cases study show replay loops identify calibrate laws frf report study-report compare share film board shock "
        "fmu export durability comfort flexible levels schemas select modes statics isolators compile"
    )
    assert not set(had.split()) - set(COMMANDS)


def test_errors_are_one_family():
    for error in (wr.ModelError, wr.RecordError, wr.SimulationError, wr.ConvergenceError):
        assert issubclass(error, wr.WireRopeError)
