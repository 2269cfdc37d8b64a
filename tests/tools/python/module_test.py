#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""module_test.py MODULE_FOLDER CAPSTAN: the Python module beside the host program, on joints made up here."""
import json
import pathlib
import struct
import subprocess
import sys
import tempfile
import unittest
import warnings

import numpy

sys.path.insert(0, sys.argv[1])
import capstan  # noqa: E402

PROGRAM = sys.argv[2]


def motion(seconds, rate_hz):
    """Reversals at several places and speeds."""
    t = numpy.arange(int(seconds * rate_hz)) / rate_hz
    return t, 0.8 * numpy.sin(0.9 * t) + 0.35 * numpy.sin(2.3 * t + 0.4)


def joint(seconds=60.0, rate_hz=200.0, play_rad=0.0, seed=1):
    """A joint with ratio 0.9 and an offset, its tendon shortened by the motor's torque, a gap in its coupling if wanted."""
    noise = numpy.random.default_rng(seed)
    t, q1 = motion(seconds, rate_hz)
    forward = numpy.gradient(q1) > 0
    tau = numpy.where(forward, 0.05, -0.04) + 0.02 * q1
    behind = numpy.empty_like(q1)
    place = q1[0]
    for i, now in enumerate(q1):  # the play operator
        place = min(max(place, now - play_rad), now + play_rad)
        behind[i] = place
    q2 = 0.9 * behind + 0.01 - numpy.where(forward, 0.3, 0.5) * tau + 0.0005 * noise.standard_normal(len(t))
    return {"time_s": t, "axis0/q1_rad": q1, "axis0/tau_Nm": tau, "axis0/q2_rad": q2}


def mcap(columns):
    """An MCAP file of JSON messages, one topic, as its specification has it: no chunks, no index."""
    def text(s):
        return struct.pack("<I", len(s)) + s.encode()

    def record(op, body):
        return bytes([op]) + struct.pack("<Q", len(body)) + body
    out = b"\x89MCAP0\r\n" + record(1, text("") + text("test"))
    out += record(4, struct.pack("<HH", 0, 0) + text("joint") + text("json") + struct.pack("<I", 0))
    names = [name for name in columns if name != "time_s"]
    for i, t in enumerate(columns["time_s"]):
        ns = round(t * 1e9)
        body = json.dumps({name: float(columns[name][i]) for name in names}).encode()
        out += record(5, struct.pack("<HIQQ", 0, i, ns, ns) + body)
    return out + record(15, struct.pack("<I", 0)) + record(2, struct.pack("<QQI", 0, 0, 0)) + b"\x89MCAP0\r\n"


class Module(unittest.TestCase):
    def setUp(self):
        warnings.simplefilter("ignore")
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def write(self, columns, name="log.csv", names=None):
        names = names or {}
        path = self.folder / name
        numpy.savetxt(path, numpy.column_stack(list(columns.values())), delimiter=",", comments="", fmt="%.17g",
                      header=",".join(names.get(column, column) for column in columns))
        return path

    def program(self, *arguments):
        return subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True)

    def sentence(self, *arguments):
        """What the program says when it stops."""
        run = self.program(*arguments)
        self.assertNotEqual(run.returncode, 0)
        return run.stderr.splitlines()[-1].removeprefix("capstan: ")

    def assert_same_fault(self, exception, sentence):
        """Cures are in the words of each."""
        self.assertEqual(str(exception).split(";")[0], sentence.split(";")[0])

    # Logs

    def test_columns_come_as_arrays(self):
        columns = joint(5.0)
        log = capstan.read_log(self.write(columns))
        self.assertEqual(log.columns, list(columns))
        self.assertEqual(len(log), 1000)
        for name, values in columns.items():
            self.assertEqual(log[name].dtype, numpy.float64)
            self.assertTrue(numpy.array_equal(log[name], values))

    def test_mapped_columns_are_worked_out(self):
        path = self.write(joint(5.0), names={"axis0/q1_rad": "motor", "axis0/tau_Nm": "current_A"})
        as_dict = capstan.read_log(path, map={"axis0/q1_rad": "motor", "axis0/tau_Nm": "current_A*0.0369"})
        as_texts = capstan.read_log(str(path), map=["axis0/q1_rad=motor", "axis0/tau_Nm=current_A*0.0369"])
        for log in (as_dict, as_texts):
            self.assertIn("axis0/tau_Nm", log)
            self.assertTrue(numpy.allclose(log["axis0/tau_Nm"], 0.0369 * log["current_A"], rtol=1e-15))

    def test_mcap_is_read(self):
        columns = joint(2.0)
        path = self.folder / "run.mcap"
        path.write_bytes(mcap({"time_s": columns["time_s"], "q1": columns["axis0/q1_rad"]}))
        log = capstan.read_log(path, map={"axis0/q1_rad": "joint/q1"})
        self.assertTrue(numpy.array_equal(log["axis0/q1_rad"], columns["axis0/q1_rad"]))

    def test_gaps_are_nan_only_where_they_are_asked_for(self):
        path = self.folder / "gaps.csv"
        path.write_text("time_s,axis0/q1_rad\n0,1\n0.1,\n0.2,3\n")
        log = capstan.read_log(path)
        self.assertTrue(numpy.array_equal(log.with_gaps("axis0/q1_rad"), [1, numpy.nan, 3], equal_nan=True))
        with self.assertRaises(capstan.BadInput):
            log["axis0/q1_rad"]

    # Errors

    def test_bad_input_is_an_exception_with_the_programs_sentence(self):
        for name, text in (("empty.csv", ""), ("back.csv", "time_s,axis0/q1_rad\n0,1\n1,2\n0.5,3\n"),
                           ("short.csv", "a,b\n1,2\n"), ("nothing.csv", None)):
            path = self.folder / name
            if text is not None:
                path.write_text(text)
            with self.assertRaises(capstan.BadInput) as raised:
                capstan.identify(path)
            self.assert_same_fault(raised.exception, self.sentence("identify", path))
            self.assertIsInstance(raised.exception, ValueError)

    def test_refusal_is_an_exception_with_the_programs_sentence(self):
        columns = joint(5.0)
        columns["axis0/tau_Nm"] = numpy.zeros(1000)
        path = self.write(columns)
        with self.assertRaises(capstan.Refusal) as raised:
            capstan.identify(path)
        self.assertEqual(str(raised.exception), self.sentence("identify", path))
        with self.assertRaises(capstan.Refusal) as raised:
            capstan.diagnose(path, target="axis0/current_A")
        self.assert_same_fault(raised.exception, self.sentence("diagnose", path, "--target", "axis0/current_A"))

    def test_nonsense_is_refused_with_its_cure(self):
        law = capstan.identify(capstan.log(joint()))
        for wrong, part in ((lambda: law.run([0.0, 1.0], [0.0]), "tau has 1 values and q1 has 2"),
                            (lambda: law.run([0.0, 1.0]), "there is no tau"),
                            (lambda: law.run([0.0, numpy.nan], [0.0, 0.0]), r"q1\[1\] is not a finite number"),
                            (lambda: law.run([0.0], [0.0], others=[([0.0], [0.0])]), "coupled to 0 other axes and others has 1"),
                            (lambda: law.run([0.0], [0.0], arithmetic="float"), "arithmetic is 'float'"),
                            (lambda: law.run([0.0], [0.0], rate_hz=0.0), "rate_hz is 0"),
                            (lambda: capstan.identify([]), "there is no log"),
                            (lambda: capstan.diagnose(capstan.log(joint(5.0)), map={"a": "b"}), "map is for files")):
            with self.assertRaisesRegex(capstan.BadInput, part):
                wrong()
        with self.assertRaises(TypeError):
            capstan.identify(3)

    def test_what_is_no_log_is_an_exception(self):
        path = self.write(joint(5.0))
        law = capstan.identify(capstan.log(joint(5.0)))
        for wrong in (None, 3, {"time_s": [0.0]}):
            for call in (lambda: capstan.identify(wrong), lambda: capstan.identify([path, wrong]),
                         lambda: capstan.diagnose(wrong), lambda: capstan.diagnose([wrong]),
                         lambda: capstan.diagnose(path, test=[wrong]), lambda: law.replay(wrong)):
                with self.assertRaisesRegex(TypeError, f"a log is given as {type(wrong).__name__}; give the path"):
                    call()

    def test_no_test_may_be_said(self):
        log = capstan.log(joint(30.0, 100.0))
        self.assertEqual(capstan.diagnose(log, test=None), capstan.diagnose(log))

    def test_nothing_is_made_without_a_value_behind_it(self):
        for kind in (capstan.Log, capstan.Law, capstan.Estimate):
            for call in (kind, lambda: kind.__new__(kind)):
                with self.assertRaisesRegex(TypeError, "made by"):
                    call()
            with self.assertRaises(TypeError):
                object.__new__(kind)

    def test_a_log_is_evidence_once(self):
        path = self.write(joint(5.0))
        link = self.folder / "link.csv"
        link.symlink_to(path)
        read, made = capstan.read_log(path), capstan.log(joint(5.0))
        for twice in ([path, path], [path, link], [path, read], [read, read], [read, capstan.read_log(path)], [made, made]):
            for command in (capstan.identify, capstan.diagnose):
                with self.assertRaisesRegex(capstan.BadInput, "is given twice"):
                    command(twice)
        with self.assertRaisesRegex(capstan.BadInput, "is among the logs that are fitted"):
            capstan.diagnose(path, test=read)
        capstan.identify([made, capstan.log(joint(5.0, seed=2))])  # two of arrays have one name

    # Laws

    def test_identified_numbers_are_those_of_the_joint(self):
        law = capstan.identify(capstan.log(joint(seed=7)))
        self.assertEqual(law.kind, "angle")
        beta = law.parameters["motor_angle.beta"]
        self.assertAlmostEqual(beta["value"], 0.9, delta=0.002)
        self.assertLess(beta["ci95"][0], beta["value"])
        self.assertAlmostEqual(law.parameters["joint_offset.offset"]["value"], 0.01, delta=0.002)
        self.assertEqual(law.parameters["joint_offset.offset"]["unit"], "rad")
        self.assertLess(law.fit["rmse"], 0.002)

    def test_law_is_the_programs(self):
        path = self.write(joint())
        self.program("identify", path, "-o", self.folder / "by_program.toml")
        capstan.identify(path).save(self.folder / "by_module.toml")
        self.assertEqual((self.folder / "by_module.toml").read_text(), (self.folder / "by_program.toml").read_text())
        again = capstan.load_law(self.folder / "by_module.toml")
        self.assertEqual(again.terms, capstan.identify(path).terms)

    def replayed(self, arithmetic, log, law):
        out = self.folder / f"{arithmetic}.csv"
        run = self.program("replay", log, "--model", law, "--arithmetic", arithmetic, "-o", out)
        self.assertEqual(run.returncode, 0, run.stderr)
        return capstan.read_log(out)["axis0/q2_est_rad"]

    def raw(self, values):
        """The firmware's numbers behind these, which a log holds to twelve decimals."""
        raw = numpy.round(values * 2.0**24)
        self.assertLess(numpy.abs(values * 2.0**24 - raw).max(), 1e-4)
        return raw.astype(numpy.int64)

    def test_fixed_arithmetic_is_the_programs_bit_for_bit(self):
        log = self.write(joint(20.0, 1000.0, play_rad=0.02))
        law = capstan.identify(log)
        law.save(self.folder / "law.toml")
        columns = capstan.read_log(log)
        mine = law.run(columns["axis0/q1_rad"], columns["axis0/tau_Nm"], arithmetic="fixed").q2
        theirs = self.replayed("fixed", log, self.folder / "law.toml")
        self.assertTrue(numpy.array_equal(mine * 2.0**24, self.raw(mine)), "every value is one of the firmware's numbers")
        self.assertTrue(numpy.array_equal(self.raw(mine), self.raw(theirs)))
        in_double = law.run(columns["axis0/q1_rad"], columns["axis0/tau_Nm"]).q2
        self.assertFalse(numpy.array_equal(mine, in_double))
        # Both switch direction within a sample of each other; elsewhere they differ by rounding.
        self.assertLess(numpy.quantile(numpy.abs(mine - in_double), 0.99), 1e-4)
        # The program takes the sample period from the log's times, and a log has twelve decimals.
        self.assertLess(numpy.abs(in_double - self.replayed("double", log, self.folder / "law.toml")).max(), 2e-12)

    def test_replay_gives_the_programs_log(self):
        log = self.write(joint(20.0, 1000.0))
        law = capstan.identify(log)
        law.save(self.folder / "law.toml")
        theirs = self.replayed("fixed", log, self.folder / "law.toml")
        self.assertEqual(law.replay(log)["axis0/q2_est_rad"].tobytes(), theirs.tobytes())

    def test_fixed_arithmetic_runs_at_the_boards_rate_only(self):
        law = capstan.identify(capstan.log(joint()))
        with self.assertRaisesRegex(capstan.Refusal, "made for 1000 Hz"):
            law.run(numpy.zeros(100), numpy.zeros(100), rate_hz=200.0, arithmetic="fixed")

    def test_numbers_beyond_the_boards_range_are_refused(self):
        law = capstan.identify(capstan.log(joint()))
        with self.assertRaisesRegex(capstan.Refusal, "reached the end of the range of numbers"):
            law.run(numpy.linspace(0, 500, 1000), numpy.zeros(1000), arithmetic="fixed")

    def test_force_law_is_read_again_and_replayed_as_by_the_program(self):
        path = self.folder / "held.csv"
        for model in ("pull_push", "preisach"):
            scenario = pathlib.Path(__file__).parents[3] / f"tools/scenarios/recipe_{model}.toml"
            self.assertEqual(self.program("run", "--scenario", scenario, "--log", path).returncode, 0)
            law = capstan.identify(path, model)
            law.save(self.folder / "force.toml")
            again = capstan.load_law(self.folder / "force.toml")
            self.assertEqual((again.kind, again.terms, again.text), ("force", [model], law.text))
            self.assertEqual(again.fit["samples"], law.fit["samples"])
            for name, number in law.parameters.items():
                self.assertEqual(again.parameters[name]["value"], number["value"])
                self.assertEqual(again.parameters[name]["ci95"] is None, number["ci95"] is None)
            out = self.folder / "out.csv"
            self.assertEqual(self.program("replay", path, "--model", self.folder / "force.toml", "-o", out).returncode, 0)
            theirs = capstan.read_log(out)["axis0/tau_out_est_Nm"]
            for one in (law, again):
                self.assertEqual(one.replay(path)["axis0/tau_out_est_Nm"].tobytes(), theirs.tobytes())
        angle = self.folder / "both.toml"
        capstan.identify(capstan.log(joint())).save(angle)
        again.save(angle)  # beside the law of the angle
        both = capstan.load_law(angle)
        self.assertEqual(both.kind, "angle")
        self.assertEqual(both.text.count("schema"), 1)
        self.assertEqual(both.replay(path)["axis0/tau_out_est_Nm"].tobytes(), theirs.tobytes())
        taken = self.program("run", "--scenario", scenario, "--model", self.folder / "force.toml", "--log", out)
        self.assertEqual(taken.returncode, 0, taken.stderr)
        self.assertGreater(numpy.abs(capstan.read_log(out)["axis0/tau_out_est_Nm"]).max(), 0.0)

    def test_effort_law_is_replayed(self):
        t, q = motion(30.0, 500.0)
        speed, acceleration = numpy.gradient(q, t), numpy.gradient(numpy.gradient(q, t), t)
        noise = 0.001 * numpy.random.default_rng(2).standard_normal(len(t))
        tau = 0.02 * acceleration + 0.05 * speed + noise
        log = capstan.log({"time_s": t, "axis0/q1_rad": q, "axis0/tau_Nm": tau})
        law = capstan.identify(log, "rigid_dynamics")
        self.assertEqual(law.kind, "effort")
        self.assertAlmostEqual(law.parameters["inertia.inertia"]["value"], 0.02, delta=0.001)
        estimate = law.replay(log, arithmetic="double")["axis0/tau_est_Nm"]
        self.assertLess(numpy.abs(estimate - tau)[100:-100].max(), 0.01)

    # Diagnosis

    def test_diagnosis_is_the_programs_contract(self):
        path = self.write(joint(120.0, 100.0, play_rad=0.03))
        said = []
        found = capstan.diagnose(path, law=self.folder / "by_module.toml", report=self.folder / "report",
                                 progress=said.append)
        self.program("diagnose", path, "--json", self.folder / "d.json", "-o", self.folder / "by_program.toml")
        theirs = json.loads((self.folder / "d.json").read_text())
        for diagnosis in (found, theirs):
            diagnosis["law"].pop("file")  # they were told to write to different ones
        self.assertEqual(found, theirs)
        self.assertEqual(found["effects"][0]["name"], "play")
        self.assertEqual((self.folder / "by_module.toml").read_text(), (self.folder / "by_program.toml").read_text())
        self.assertTrue(any((self.folder / "report").iterdir()))
        self.assertTrue(said)

    def test_what_is_read_is_not_written(self):
        path, test = self.write(joint(5.0)), self.folder / "test.csv"
        test.write_bytes(path.read_bytes())
        law = self.folder / "law.toml"
        capstan.identify(path).save(law)
        before = {file: file.read_bytes() for file in (path, test, law)}
        link = self.folder / "link.toml"
        link.symlink_to(law)
        called = []
        for arguments, part in (({"law": path}, "law would replace .*, which logs reads; give law another name"),
                                ({"next": path}, "next would replace .*, which logs reads"),
                                ({"test": test, "law": test}, "law would replace .*, which test reads"),
                                ({"base": str(law), "law": link}, "law would replace .*, which base reads"),
                                ({"law": self.folder / "one", "next": self.folder / "." / "one"}, "would write the same file"),
                                ({"law": "/nonexistent/law.toml"}, "there is no folder /nonexistent"),
                                ({"report": law}, "is a file; name a folder")):
            for logs in (path, [capstan.read_log(path)]):
                with self.assertRaisesRegex(capstan.BadInput, part):
                    capstan.diagnose(logs, progress=called.append, **arguments)
        self.assertEqual(called, [])
        self.assertEqual({file: file.read_bytes() for file in before}, before)

    def test_exception_in_progress_ends_the_diagnosis(self):
        def stop(_):
            raise KeyError("enough")
        with self.assertRaises(KeyError):
            capstan.diagnose(capstan.log(joint(30.0, 100.0)), progress=stop)

    def test_what_was_done_with_a_log_is_a_warning(self):
        path = self.write(joint(30.0))
        path.write_bytes(path.read_bytes()[:-5])  # the last line is cut off
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            capstan.identify(path)
        self.assertTrue(any("last line" in str(one.message) for one in caught), [str(one.message) for one in caught])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
