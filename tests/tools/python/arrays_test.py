#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""arrays_test.py MODULE_FOLDER CAPSTAN: logs of a caller's arrays, and what is said of them."""
import sys
import tempfile
import unittest

import numpy
try:
    import pandas
except ImportError:
    pandas = None
from module_test import capstan, joint, motion


class Arrays(unittest.TestCase):
    def test_arrays_make_a_log(self):
        columns = joint(5.0)
        log = capstan.log(columns)
        for name, values in columns.items():
            self.assertTrue(numpy.array_equal(log[name], values), name)
        with self.assertRaisesRegex(capstan.BadInput, "column time_s has 2 values"):
            capstan.log({"axis0/q1_rad": numpy.zeros(3), "time_s": numpy.zeros(2)})

    def test_arrays_are_mapped(self):
        log = capstan.log({"t": [0.0, 1.0, 2.0], "motor": [1.0, 2.0, 4.0]}, map={"time_s": "t*1e-3", "axis0/q1_rad": "motor*2"})
        self.assertTrue(numpy.array_equal(log["axis0/q1_rad"], [2.0, 4.0, 8.0]))
        self.assertTrue(numpy.allclose(log["time_s"], [0.0, 1e-3, 2e-3]))

    def test_a_data_frame_makes_a_log(self):
        class Frame:  # what pandas' has of a mapping: no dict, its columns in their order, names that may be numbers
            def __init__(self, columns):
                self.columns = columns

            def items(self):
                return iter(self.columns.items())
        columns = {"time_s": numpy.arange(3.0), "axis0/q1_rad": numpy.arange(3)}
        log = capstan.log(Frame(columns))
        self.assertEqual(log.columns, list(columns))
        self.assertTrue(numpy.array_equal(log["axis0/q1_rad"], [0.0, 1.0, 2.0]))
        for wrong, part in ((Frame({0: numpy.zeros(3)}), "a column is named 0; give its name"),
                            (numpy.zeros((3, 2)), "columns are given as ndarray; give names"),
                            ({"time_s": ["a", "b"]}, "column time_s is given as list; give numbers in one dimension"),
                            ({"time_s": [0.0, 1j]}, "column time_s is of complex numbers; give their real part")):
            with self.assertRaisesRegex(TypeError, part):
                capstan.log(wrong)

    def test_a_name_that_no_header_holds_is_refused_by_its_name(self):
        plain = {"time_s": numpy.arange(3.0), "axis0/q1_rad": numpy.arange(3.0)}
        for name in ("force (N, filtered)", "a\nb", "", 'a"b', "a\tb"):
            with self.assertRaises(capstan.BadInput) as raised:
                capstan.log({**plain, name: numpy.zeros(3)})
            self.assertIn(f"a column is named {name!r}, which no log can hold", str(raised.exception))
        with self.assertRaisesRegex(TypeError, r"a column is named '\\ud800'"):
            capstan.log({**plain, "\ud800": numpy.zeros(3)})
        for name in ("a;b", " a", "#a", "a'b", "Kraft [N]", "\u00e4"):
            log = capstan.log({**plain, name: numpy.ones(3)})
            self.assertEqual(len(log.columns), 3, name)
            self.assertTrue(numpy.array_equal(log["axis0/q1_rad"], numpy.arange(3.0)), name)

    @unittest.skipIf(pandas is None, "pandas is not installed")
    def test_columns_of_a_data_frame_may_have_missing_values_and_a_time_zone(self):
        zoned = pandas.Series(pandas.to_datetime([0.0, 0.5, 1.0], unit="s", utc=True))
        for times in (zoned, pandas.DatetimeIndex(zoned), zoned.dt.tz_convert("Europe/Amsterdam")):
            for numbers in (pandas.array([1, None, 3], dtype="Int64"), pandas.array([1.0, None, 3.0], dtype="Float64")):
                log = capstan.log(pandas.DataFrame({"time_s": times, "axis0/q1_rad": numbers}))
                self.assertTrue(numpy.array_equal(log["time_s"], [0.0, 0.5, 1.0]))
                self.assertTrue(numpy.array_equal(log.with_gaps("axis0/q1_rad"), [1.0, numpy.nan, 3.0], equal_nan=True))
        switched = pandas.Series([True, None, False], dtype="boolean")
        log = capstan.log({"time_s": numpy.arange(3.0), "brake": switched})
        self.assertTrue(numpy.array_equal(log.with_gaps("brake"), [1.0, numpy.nan, 0.0], equal_nan=True))
        with self.assertRaisesRegex(TypeError, "column axis0/q1_rad is given as Series"):
            capstan.log({"time_s": numpy.arange(2.0), "axis0/q1_rad": pandas.Series(["a", None], dtype="string")})

    def test_complex_numbers_are_never_cut_to_their_real_part(self):
        law = capstan.identify(capstan.log(joint(5.0)))
        for values in (numpy.zeros(3, complex), numpy.ma.masked_array(numpy.zeros(3, complex))):
            with self.assertRaisesRegex(TypeError, "an array is of complex numbers"):
                law.run(values, numpy.zeros(3))

    def test_times_of_the_calendar_are_seconds(self):
        start = numpy.datetime64("2026-03-01T08:00:00", "ns")
        steps = numpy.array([0, 250, 500], "timedelta64[us]")
        for times in (start + steps, steps, numpy.ma.masked_array(start + steps)):
            log = capstan.log({"time_s": times, "axis0/q1_rad": numpy.arange(3.0)})
            self.assertTrue(numpy.array_equal(log["time_s"], [0.0, 250e-6, 500e-6]))

    def test_masked_values_and_nan_are_gaps(self):
        masked = numpy.ma.masked_array([1.0, 2.0, 3.0], mask=[False, True, False])
        for values in (masked, numpy.array([1.0, numpy.nan, 3.0])):
            log = capstan.log({"time_s": numpy.arange(3.0), "axis0/q1_rad": values})
            self.assertTrue(numpy.array_equal(log.with_gaps("axis0/q1_rad"), [1, numpy.nan, 3], equal_nan=True))
        columns = joint()
        columns["axis0/tau_Nm"] = numpy.ma.masked_array(columns["axis0/tau_Nm"], mask=True)
        with self.assertRaisesRegex(capstan.BadInput, "axis0/tau_Nm is empty"):
            capstan.identify(capstan.log(columns))
        law = capstan.identify(capstan.log(joint()))
        with self.assertRaisesRegex(capstan.BadInput, r"q1\[1\] is not a finite number"):
            law.run(masked, [0.0, 0.0, 0.0])

    def test_cures_are_pythons(self):
        t, q1 = motion(20.0, 100.0)
        in_ns = {"time_s": t * 1e9, "axis0/q1_rad": q1, "axis0/q2_rad": q1, "axis0/tau_Nm": q1}
        with self.assertRaisesRegex(capstan.BadInput, r'^the arrays, row 0: .* read it with map={"time_s": "time_s\*1e-9"}'):
            capstan.identify(capstan.log(in_ns))
        capstan.identify(capstan.log(in_ns, map={"time_s": "time_s*1e-9"}), "kinematic")
        back = {**in_ns, "time_s": numpy.where(t < 5.0, t, t - 1.0)}
        with self.assertRaisesRegex(capstan.BadInput, "^the arrays, row 500: time_s"):
            capstan.identify(capstan.log(back))
        still = {**in_ns, "time_s": t, "axis0/q1_rad": 0 * t}
        with self.assertRaisesRegex(capstan.BadInput, "^the arrays, row 0: .* from here to row 1999; .* column with map$"):
            capstan.identify(capstan.log(still))
        log = capstan.log({**in_ns, "time_s": t})
        with tempfile.TemporaryDirectory() as folder:
            law_file = folder + "/law.toml"
            capstan.identify(log, "kinematic").save(law_file)
            self.expect_cures(log, in_ns, law_file)

    def expect_cures(self, log, in_ns, law_file):
        for call, cure in ((lambda: capstan.identify(log, coupled_to=[0]), r"^coupled_to=\[0\] is the axis itself"),
                           (lambda: capstan.identify(log, coupled_to=[1]), r'name its column with map={"axis1/q1_rad": "COLUMN"}$'),
                           (lambda: capstan.log(in_ns, map={"x": "sqrt(-2 - axis0/q1_rad)"})["x"],
                            r'^map={"x": "sqrt\(-2 - axis0/q1_rad\)"}: has no value at row 0 of the arrays;'),
                           (lambda: capstan.read_log("log.csv", map=["x"]), r"^map x: there is no '='"),
                           (lambda: capstan.identify(log, "rigid_dynamics", target="axis0/q2_rad"),
                            "name the effort with target=\"axis0/tau_Nm\""),
                           (lambda: capstan.diagnose(log, base=law_file, target="axis0/tau_Nm"),
                            "leave target out, or give the name of a law instead, rigid_dynamics")):
            with self.assertRaisesRegex(capstan.BadInput, cure):
                call()
        with self.assertRaisesRegex(capstan.Refusal, r'map={"axis0/tau_Nm": "axis0/i_A\*FACTOR"} target="axis0/tau_Nm"$'):
            capstan.identify(log, target="axis0/i_A")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
