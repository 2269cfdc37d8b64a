// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace capstan::sim {

/// What the tip touches. The torque acts on the joint against its motion; q2 is the joint angle.
enum class EnvironmentKind {
  kFree,          ///< nothing
  kLocked,        ///< the joint cannot move
  kSpring,        ///< stiffness (q2 - angle)
  kKelvinVoigt,   ///< spring plus damping q2'
  kHuntCrossley,  ///< one-sided contact beyond `angle`: stiffness d^1.5 (1 + damping d'), d = q2 - angle > 0
  kLayered,       ///< one-sided contact with a soft layer over a deep one and an inclusion, times (1 + damping d')
};

struct Environment {
  EnvironmentKind kind = EnvironmentKind::kFree;
  double stiffness = 0.0;  ///< N m/rad, or N m/rad^1.5 for kHuntCrossley
  double damping = 0.0;    ///< N m s/rad, or s/rad for kHuntCrossley
  double angle_rad = 0.0;  ///< rest angle, or the angle where the contact begins
  // kLayered: `stiffness` down to layer_depth, deep_stiffness below. Pressed at `site`, the inclusion adds
  // inclusion_stiffness exp(-((site - inclusion_site) / inclusion_width)^2) from inclusion_depth on. Every site_period
  // the tip goes on by site_step: palpation of a row of sites in one run.
  double layer_depth_rad = 0.1;
  double deep_stiffness = 0.0;       ///< N m/rad
  double inclusion_stiffness = 0.0;  ///< N m/rad
  double inclusion_depth_rad = 0.05;
  double inclusion_site_m = 0.0;
  double inclusion_width_m = 0.005;
  double site_m = 0.0;
  double site_step_m = 0.0;
  double site_period_s = 0.0;  ///< 0: the tip stays at its site
};

/// Effects a joint may have without its model knowing. All off by default; nothing outside the plant is told about
/// them. The comment at each says what is done to the physics.
struct Effects {
  // Drag proportional to the local speed of each tendon along its whole length; forward is the direction of q1' > 0.
  double transmission_viscous_forward_ns_per_m = 0.0;
  double transmission_viscous_backward_ns_per_m = 0.0;
  // Free play between the output pulley and the joint. The joint's own friction holds it inside the gap.
  double play_half_width_rad = 0.0;
  // The joint camera's value is late.
  double transport_delay_s = 0.0;
  // Both tendons are shortened (or lengthened) equally at the given time.
  double pretension_change_n = 0.0;
  double pretension_change_at_s = 0.0;
  // A mass on the link: torque * sin(q2 + angle).
  double gravity_torque_nm = 0.0;
  double gravity_angle_rad = 0.0;
  // Every tendon element is a standard linear solid: it creeps by ratio * (elastic elongation) with this time constant.
  double creep_ratio = 0.0;
  double creep_time_s = 10.0;
  // The top run grows as the instrument warms up from one side: growth * (1 - exp(-t / time)).
  double thermal_growth_m = 0.0;
  double thermal_time_s = 300.0;
  // Eccentric encoder disc: reads q1 + amplitude sin(per_turn q1 + phase).
  double angle_periodic_rad = 0.0;
  double angle_periodic_per_turn = 5.0;
  double angle_periodic_phase_rad = 0.0;
  // Tendon tension is F (1 + hardening F), F the linear elastic force.
  double hardening_per_n = 0.0;
  // More inertia on the link.
  double load_inertia_kgm2 = 0.0;
  // A second joint swings, angle sin(2 pi frequency t), and this joint's tendons pass it at the radius: what goes
  // around it on the top run is missing on the bottom run.
  double axis_coupling_rad = 0.0;
  double axis_coupling_hz = 0.17;
  double axis_coupling_radius_m = 1.6e-3;
  // Elastic friction at the joint beside its Coulomb friction: a spring that yields at this torque and deflection.
  double presliding_nm = 0.0;
  double presliding_width_rad = 0.02;
  // The motor's: more viscous and Coulomb friction, both larger forward than backward by a share, a static excess that
  // fades with speed, elastic friction, a constant torque.
  double viscous_friction_nms_per_rad = 0.0;
  double coulomb_friction_nm = 0.0;
  double friction_asymmetry = 0.0;
  double stribeck_nm = 0.0;
  double stribeck_rad_per_s = 0.1;
  double play_friction_nm = 0.0;
  double play_friction_width_rad = 0.05;
  double offset_nm = 0.0;

  // Outside any catalogue:
  // wear: eta grows by this share per radian travelled by the input pulley.
  double wear_per_rad = 0.0;
  // sticky_spot: more Coulomb friction at the joint, a bell of this width around one angle.
  double sticky_spot_nm = 0.0;
  double sticky_spot_angle_rad = 0.2;
  double sticky_spot_width_rad = 0.05;
  // magnetic_detent: motor cogging, torque * sin(per_turn q1).
  double magnetic_detent_nm = 0.0;
  double magnetic_detent_per_turn = 35.0;
  // fraying: strands of the top run tear along its whole length, and this share of its stiffness goes with them.
  double fraying_share = 0.0;
  double fraying_at_s = 10.0;
  // pulley_slip: the input pulley turns on its shaft by this angle, once or again and again.
  double pulley_slip_rad = 0.0;
  double pulley_slip_at_s = 10.0;
  double pulley_slip_every_s = 0.0;  // again and again; 0: once
  // tremor: a periodic torque on the tip.
  double tremor_nm = 0.0;
  double tremor_hz = 3.0;
  // sheath_bend: the tendons' path is bent more as the joint turns: eta (1 + bend |q2|).
  double sheath_bend_per_rad = 0.0;
  // torque_fade: the motor's magnets weaken by this share with this time constant.
  double torque_fade = 0.0;
  double torque_fade_time_s = 30.0;
};

/// How the plant goes through time. A free tip on its tendons has modes of a few hundred hertz.
enum class SolverMode {
  kQuasiStatic,  ///< follows the equilibrium: modes near and above the sub-steps' rate are damped out
  kDynamic,      ///< keeps the modes, for inputs of high frequency; twice the work
};

/// One axis of an instrument, SI units. Defaults: da Vinci micro-forceps (F. Anooshahpour, 2017, ch. 2 and 5) for the
/// transmission; motor, sensors and joint friction are those of a 15 W class brushed motor with a 5:1 gear.
struct PlantParameters {
  // Motor, referred to the input pulley.
  double motor_inertia_kgm2 = 2.0e-5;
  double motor_viscous_nms_per_rad = 2.0e-4;
  double motor_coulomb_nm = 0.003;
  double torque_constant_nm_per_a = 0.1;
  double current_limit_a = 2.5;
  double current_bandwidth_hz = 300.0;
  // Transmission. eta is the friction-bending number mu L / R, stiffness is E A / L.
  double input_radius_m = 2.6e-3;
  double output_radius_m = 2.4e-3;
  double eta_top = 1.1414;
  double eta_bottom = 1.1404;
  double stiffness_top_n_per_m = 5.0664e4;
  double stiffness_bottom_n_per_m = 5.0831e4;
  double pretension_n = 27.6984;  ///< I = integral(Tt) + integral(Tb)
  int element_count = 16;         ///< per tendon
  int substeps = 4;               ///< of the 1 ms step
  SolverMode mode = SolverMode::kQuasiStatic;
  // Joint.
  double joint_inertia_kgm2 = 4.0e-7;
  double joint_viscous_nms_per_rad = 2.0e-4;
  double joint_coulomb_nm = 0.002;
  // End stops of the joint: springs beyond these angles. 0 stiffness: there are none.
  double stop_low_rad = -3.0;
  double stop_high_rad = 3.0;
  double stop_stiffness_nm_per_rad = 0.0;
  // Sensors the firmware sees.
  double encoder_counts_per_turn = 40960.0;  ///< of the input pulley, after quadrature and gear
  double encoder_start_counts = 0.0;         ///< what the counter shows at q1 = 0
  double current_noise_a = 0.003;            ///< white, standard deviation at 1 kHz
  double current_offset_a = 0.002;
  double current_adc_step_a = 0.00122;
  double current_full_scale_a = 2.5;
  double sample_delay_s = 0.0;  ///< both are sampled this long before the board reads them
  // Joint camera, for the log; with joint_sensor = 1 the board reads it too.
  double camera_noise_rad = 0.0017;
  double camera_rate_hz = 0.0;  ///< 0: every step; otherwise the value is held between frames
  double camera_delay_s = 0.0;
  double joint_sensor = 0.0;  ///< 0 or 1
  // Tip force sensor, for the log only.
  double tip_length_m = 0.01;  ///< joint axis to tip
  double tip_force_noise_n = 0.02;
  // Thermometer, of log and board. The instrument warms up from ambient by `warming` as effects.thermal_time_s says; 0:
  // there is no thermometer.
  double ambient_c = 25.0;
  double warming_k = 0.0;
  double thermometer_noise_k = 0.05;

  Environment environment;
  Effects effects;
};

/// Checks every range and the relations between fields. Throws std::invalid_argument with "name: sentence; cure".
void validate(const PlantParameters& parameters);

}  // namespace capstan::sim
