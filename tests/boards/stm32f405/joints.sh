# SPDX-License-Identifier: Apache-2.0
# To be sourced: a scenario with as many equal joints as the board has axes.
write_scenario() {  # folder, axes
  {
    echo 'name = "joints of a test"'
    for ((i = 0; i < $2; ++i)); do printf '[[axes]]\nname = "joint%d"\n[axes.plant]\npretension_n = 27.6984\nelement_count = 4\n' "$i"; done
  } > "$1/joints.toml"
  printf 'name = "closed loop"\nseed = 1\ninstrument = "joints.toml"\n' > "$1/scenario.toml"
}
