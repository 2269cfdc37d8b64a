#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""A joint made of a formula, with a gap that the usual law does not know: identified, diagnosed, corrected, and run as a board would."""
import pathlib
import tempfile

import numpy
import capstan

rate_hz, seconds, gap_rad = 1000, 60, 0.03
t = numpy.arange(rate_hz * seconds) / rate_hz
q1 = 0.8 * numpy.sin(0.9 * t) + 0.35 * numpy.sin(2.3 * t + 0.4)
tau = 0.045 * numpy.tanh(numpy.gradient(q1, t) / 0.05) + 0.02 * q1
behind_the_gap = numpy.empty_like(q1)
place = q1[0]
for i, now in enumerate(q1):
    place = min(max(place, now - gap_rad), now + gap_rad)
    behind_the_gap[i] = place
q2 = 0.9 * behind_the_gap - 0.3 * tau + 0.0005 * numpy.random.default_rng(1).standard_normal(len(t))

log = capstan.log({"time_s": t, "axis0/q1_rad": q1, "axis0/tau_Nm": tau, "axis0/q2_rad": q2})
usual = capstan.identify(log)
print(usual, usual.fit)

law_file = pathlib.Path(tempfile.mkdtemp()) / "corrected.toml"
diagnosis = capstan.diagnose(log, law=law_file)
print(diagnosis["verdict"], [effect["name"] for effect in diagnosis["effects"]])
print("error before", diagnosis["before"]["rmse"], "rad, after", diagnosis["after"]["rmse"], "rad")

corrected = capstan.load_law(law_file)
on_the_board = corrected.run(q1, tau, arithmetic="fixed").q2
print("on the board:", numpy.sqrt(numpy.mean((on_the_board - q2) ** 2)), "rad")
