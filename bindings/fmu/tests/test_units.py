"""Units of FMI 3.0 in FMPy: what they compute is what `hodograph simulate` computes."""

import csv
import io
import os
import shutil
import subprocess
from ctypes import c_double
from pathlib import Path

import numpy as np
import pytest
from fmpy import extract, read_model_description, simulate_fmu
from fmpy.fmi1 import FMICallException
from fmpy.fmi3 import FMU3Model, FMU3Slave, fmi3LogMessageCallback
from fmpy.validation import validate_fmu

HERE = Path(__file__).parent
ROOT = HERE.parent.parent.parent
UNITS = HERE.parent / "target" / "units"
SURFACE = ["--mu", "0.4", "--e", "0.5", "--law", "stronge"]

# name: model, options of the tool, end of the motion
MECHANISMS = {
    "ball": (HERE / "models/ball.mech", [], 3.0),
    "coupled": (HERE / "models/coupled.mech", [], 2.0),
    "four_bar": (ROOT / "models/four_bar.mech", SURFACE, 2.0),
    "planar_double_pendulum": (ROOT / "models/planar_double_pendulum.mech", SURFACE, 1.5),
    "hopper": (ROOT / "simulation/models/hopper.mech", SURFACE, 1.0),
    "tumbling_box": (ROOT / "simulation/models/tumbling_box.mech", SURFACE, 1.0),
}
STEP = 0.01


def by_the_tool(model, options, until):
    """The rows of samples, by name of column, and the number of events."""
    command = [os.environ["HODOGRAPH_TOOL"], "simulate", str(model), "--until", str(until), "--step", str(STEP), "--format", "csv"]
    said = subprocess.run(command + options, capture_output=True, text=True, check=True).stdout
    rows = list(csv.DictReader(io.StringIO(said)))
    samples = [row for row in rows if not row["event"]]
    names = [name for name in samples[0] if name not in ("event", "contact")]
    # An event at the time of a sample is before it.
    return {name: np.array([float(row[name]) for row in samples]) for name in names}, len(rows) - len(samples)


@pytest.mark.parametrize("name", MECHANISMS)
def test_units_are_valid(name):
    assert validate_fmu(UNITS / f"{name}.fmu") == []


@pytest.mark.parametrize("name", MECHANISMS)
def test_co_simulation_is_the_motion_of_the_tool(name):
    model, options, until = MECHANISMS[name]
    expected, events = by_the_tool(model, options, until)
    found = simulate_fmu(UNITS / f"{name}.fmu", fmi_type="CoSimulation", stop_time=until, output_interval=STEP)
    assert len(found) == len(expected["t"])
    for column in expected:
        if column == "t":
            continue
        near = np.abs(found[column] - expected[column]) <= 1e-9 * (1 + np.abs(expected[column]))
        assert near.all(), (column, np.abs(found[column] - expected[column]).max())
    assert found["events"][-1] == events


@pytest.mark.parametrize(
    "name, until, near",
    [("ball", 2.0, 1e-7), ("coupled", 2.0, 1e-6), ("four_bar", 2.0, 1e-6), ("planar_double_pendulum", 1.0, 1e-5),
     ("hopper", 0.6, 1e-5), ("tumbling_box", 0.5, 1e-4)],
)
def test_model_exchange_is_the_motion_of_the_tool(name, until, near):
    model, options, _ = MECHANISMS[name]
    expected, _ = by_the_tool(model, options, until)
    found = simulate_fmu(
        UNITS / f"{name}.fmu",
        fmi_type="ModelExchange",
        solver="CVode",
        relative_tolerance=1e-10,
        stop_time=until,
        output_interval=STEP,
        record_events=False,
    )
    for column in expected:
        if column == "t":
            continue
        at = np.interp(expected["t"], found["time"], found[column])
        assert abs(at[-1] - expected[column][-1]) <= near * (1 + abs(expected[column][-1])), column
    assert found["events"][-1] > 0 or name == "four_bar"


class Unit:
    """A unit of which functions are called one by one."""

    def __init__(self, name, kind=FMU3Slave):
        self.folder = extract(UNITS / f"{name}.fmu")
        self.description = read_model_description(self.folder)
        self.references = {variable.name: variable.valueReference for variable in self.description.modelVariables}
        interface = self.description.coSimulation if kind is FMU3Slave else self.description.modelExchange
        self.fmu = kind(
            guid=self.description.guid,
            unzipDirectory=self.folder,
            modelIdentifier=interface.modelIdentifier,
            instanceName=name,
        )

    def start(self, time=0.0, **values):
        self.fmu.instantiate()
        self.set(**values)
        self.fmu.enterInitializationMode(startTime=time)
        self.fmu.exitInitializationMode()
        return self

    def set(self, **values):
        if values:
            self.fmu.setFloat64([self.references[name] for name in values], list(values.values()))

    def get(self, *names):
        return self.fmu.getFloat64([self.references[name] for name in names])

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.fmu.freeInstance()
        shutil.rmtree(self.folder, ignore_errors=True)


def test_parameters_and_start_values_are_those_that_are_set():
    with Unit("ball").start(h=2.0, g=5.0, **{"contacts.floor.e": 0.5}) as ball:
        fall = np.sqrt(2 * 2.0 / 5.0)
        ball.fmu.doStep(0.0, 0.5)
        assert np.allclose(ball.get("h", "v"), [2.0 - 2.5 * 0.25, -2.5], rtol=0, atol=1e-13)
        ball.fmu.doStep(0.5, fall)
        # It left the floor with half of its speed at t = fall.
        after = 0.5
        h = 0.5 * 5.0 * fall * after - 2.5 * after**2
        assert abs(ball.get("h")[0] - h) < 1e-11
        assert ball.fmu.getInt64([ball.references["events"]]) == [1]


def test_a_pull_is_held_by_friction_up_to_its_bound():
    with Unit("block").start() as block:
        block.set(F=3.9)
        block.fmu.doStep(0.0, 1.0)
        assert block.get("x", "u") == [0.0, 0.0]
        assert block.fmu.getInt64([block.references["contacts.floor.phase"]]) == [1]
        block.set(F=4.9)
        block.fmu.doStep(1.0, 1.0)
        rate = (4.9 - 0.2 * 2 * 9.81) / 2
        assert np.allclose(block.get("x", "u"), [rate / 2, rate], rtol=0, atol=1e-11)
        assert np.allclose(block.get("contacts.floor.force.n", "der(u)"), [2 * 9.81, rate], rtol=0, atol=1e-11)


def test_states_are_saved_restored_and_serialised_to_the_bit():
    with Unit("tumbling_box").start() as box:
        names = ["x", "y", "z", "e0", "u1", "u4", "energy.kinetic"]
        box.fmu.doStep(0.0, 0.35)
        saved = box.fmu.getFMUState()
        image = box.fmu.serializeFMUState(saved)
        runs = []
        for restore in (None, lambda: saved, lambda: box.fmu.deserializeFMUState(image)):
            if restore:
                box.fmu.setFMUState(restore())
            for step in range(40):
                box.fmu.doStep(0.35 + step * 0.01, 0.01)
            runs.append(box.get(*names))
        assert runs[0] == runs[1] == runs[2]
        box.fmu.reset()
        box.fmu.enterInitializationMode()
        box.fmu.exitInitializationMode()
        box.fmu.doStep(0.0, 0.35)
        for step in range(40):
            box.fmu.doStep(0.35 + step * 0.01, 0.01)
        assert box.get(*names) == runs[0]


def test_an_image_of_another_unit_is_refused():
    with Unit("ball").start() as ball, Unit("block").start() as block:
        state = block.fmu.getFMUState()
        image = block.fmu.serializeFMUState(state)
        foreign = ball.fmu.deserializeFMUState(image)
        before = ball.get("h")
        with pytest.raises(FMICallException):
            ball.fmu.setFMUState(foreign)
        assert ball.get("h") == before


def test_directional_derivatives_are_known_ones_and_those_of_differences():
    with Unit("block", FMU3Model).start() as block:
        block.fmu.enterContinuousTimeMode()
        of = block.references
        # Friction holds the block: neither the pull nor its speed changes anything.
        assert block.fmu.getDirectionalDerivative([of["der(u)"]], [of["F"]], [1.0]) == [0.0]
        # The force of friction is the pull.
        found = block.fmu.getDirectionalDerivative([of["contacts.floor.force.t"]], [of["F"]], [2.0])
        assert abs(abs(found[0]) - 2.0) < 1e-10
    with Unit("planar_double_pendulum", FMU3Model).start() as pendulum:
        pendulum.fmu.enterContinuousTimeMode()
        of = pendulum.references
        states = np.array(pendulum.get("q1", "q2", "u1", "u2"))
        unknowns = ["der(u1)", "der(u2)", "points.P2.x", "energy.kinetic"]

        def at(change):
            moved = states + change
            pendulum.fmu.setContinuousStates((c_double * 4)(*moved), 4)
            return np.array(pendulum.get(*unknowns))

        for place, name in enumerate(["q1", "q2", "u1", "u2"]):
            found = pendulum.fmu.getDirectionalDerivative([of[one] for one in unknowns], [of[name]], [1.0])
            unit = np.eye(4)[place]
            # A difference of another order and another step.
            h = 1e-4
            expected = (at(-2 * h * unit) - 8 * at(-h * unit) + 8 * at(h * unit) - at(2 * h * unit)) / (12 * h)
            at(0 * unit)
            assert np.allclose(found, expected, rtol=1e-8, atol=1e-8), (name, found, expected)


def test_twenty_states_have_the_bits_of_every_door():
    table = np.loadtxt(ROOT / "tests/data/doors/planar_double_pendulum.csv", delimiter=",", skiprows=1)
    assert len(table) == 20
    with Unit("planar_double_pendulum", FMU3Model).start() as pendulum:
        pendulum.fmu.enterContinuousTimeMode()
        for row in table:
            pendulum.fmu.setContinuousStates((c_double * 4)(*row[:4]), 4)
            found = pendulum.get("der(u1)", "der(u2)", "energy.kinetic")
            assert np.array(found).tobytes() == np.array(row[4:]).tobytes(), row


def together(step, until):
    """Two blocks and a spring between them, which the master computes from step to step."""
    with Unit("block").start() as one, Unit("block").start(x=1.0) as two:
        for place in range(round(until / step)):
            pull = 50.0 * (two.get("x")[0] - one.get("x")[0])
            one.set(F=pull)
            two.set(F=-pull)
            for block in (one, two):
                block.fmu.doStep(place * step, step)
        return np.array([*one.get("x", "u"), *two.get("x", "u")])


def test_two_units_simulated_together_approach_the_mechanism_of_both():
    until = 0.4
    with Unit("coupled").start() as coupled:
        coupled.fmu.doStep(0.0, until)
        expected = np.array(coupled.get("x1", "u1", "x2", "u2"))
    errors = [np.abs(together(step, until) - expected).max() for step in (2e-3, 1e-3)]
    # Forces are held over a step: the error is of the first order.
    assert errors[1] < 6e-3 and 1.7 < errors[0] / errors[1] < 2.3, errors


def test_what_is_wrong_is_refused_with_a_sentence():
    with Unit("ball") as ball:
        told = []

        def log(_, status, category, message):
            told.append((status, message.decode()))

        ball.fmu.instantiate(logMessage=fmi3LogMessageCallback(log))
        with pytest.raises(FMICallException):
            ball.set(h=float("nan"))
        with pytest.raises(FMICallException):
            ball.get("contacts.floor.gap")
        with pytest.raises(FMICallException):
            ball.fmu.getFloat64([999])
        with pytest.raises(FMICallException):
            ball.set(**{"der(v)": 1.0})
        ball.set(h=-1.0)
        ball.fmu.enterInitializationMode()
        with pytest.raises(FMICallException):
            ball.fmu.exitInitializationMode()
        ball.set(h=1.0)
        ball.fmu.exitInitializationMode()
        with pytest.raises(FMICallException):
            ball.set(m=2.0)
        with pytest.raises(FMICallException):
            ball.fmu.doStep(0.0, -1.0)
        with pytest.raises(FMICallException):
            ball.fmu.doStep(0.7, 0.1)
        ball.fmu.doStep(0.0, 0.1)
        words = [message for _, message in told]
        for expected in (
            "h is NaN: it must be finite",
            "values are computed from the initialization on",
            "there is no variable with the value reference 999",
            "der(v) is computed: it cannot be set",
            "at t = 0, contact floor: the negative gap -1: start where the bodies are apart, or touch",
            "m cannot be set any more",
            "the step is -1 s: it must be positive",
            "the step begins at 0.7 s, but the motion is at 0 s",
        ):
            assert any(expected in message for message in words), (expected, words)


def test_the_token_of_another_unit_is_refused():
    with Unit("ball").start() as ball:
        ball.fmu.guid = "another"
        with pytest.raises(Exception):
            Unit.start(ball)
        ball.fmu.guid = ball.description.guid

