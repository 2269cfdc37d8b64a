// SPDX-License-Identifier: Apache-2.0
// The shell's view of the law: what it adds up, term by term.
#include <algorithm>

#include "capstan/firmware/console/shell_commands.hpp"
#include "capstan/firmware/parameters/effort_rows.hpp"

namespace capstan {
namespace {

/// Walks the catalogue in its order and prints the terms that are on, with their equations and parameters.
/// @tparam Torque  it is the effort law: its terms may come several times, and what multiplies them are torques
template <bool Torque>
class LawPrinter {
 public:
  LawPrinter(Print& out, std::span<const Q24> coefficients, std::span<const Q24> shapes)
      : out_(out), coefficients_(coefficients), shapes_(shapes) {}

  template <typename Term>
  void operator()() {
    const auto coefficients = coefficients_.subspan(coefficient_, kCoefficientsOf<Term>);
    const auto shapes = shapes_.subspan(shape_, kShapesOf<Term>);
    coefficient_ += coefficients.size();
    shape_ += shapes.size();
    const auto on = [](Q24 value) { return value != Q24{}; };
    const auto works = [&shapes](std::size_t i) {  // what the law has several of may be idle
      const int switched = Term::kInfo.shapes[i].idle_without;
      return switched < 0 || shapes[static_cast<std::size_t>(switched)] != Q24{};
    };
    bool active = std::any_of(coefficients.begin(), coefficients.end(), on);
    for (std::size_t i = 0; coefficients.empty() && i < shapes.size(); ++i) {
      active |= works(i) && on(shapes[i]);
    }
    if (!active) {
      ++off_;
      return;
    }
    out_ << "  " << name_of<Term>() << ": " << Term::kInfo.equation << " " << Term::kInfo.source << "\r\n";
    for (std::size_t i = 0; i < coefficients.size(); ++i) {
      if (one_at_a_time<Term>() && !on(coefficients[i])) {
        continue;  // of a table's knots those in use
      }
      const CoefficientInfo& declared = Term::kInfo.coefficients[i];
      const CoefficientInfo info = Torque ? of_torque(declared) : declared;
      print(info.name, coefficients[i], info.unit, info.doc);
    }
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      if (!works(i)) {
        continue;
      }
      print(Term::kInfo.shapes[i].name, shapes[i], Term::kInfo.shapes[i].unit, Term::kInfo.shapes[i].doc);
    }
  }
  [[nodiscard]] auto off() const -> std::uint32_t { return off_; }

 private:
  template <typename Term>
  static auto name_of() -> const char* {
    if constexpr (Torque) {
      return kEffortGroup<Term>.data();
    } else {
      return Term::kInfo.name;
    }
  }
  void print(const char* name, Q24 value, const char* unit, const char* doc) {
    out_ << "    " << name << ' ' << value;
    if (std::string_view(unit) != "1") {
      out_ << ' ' << unit;
    }
    out_ << "  " << doc << "\r\n";
  }

  Print& out_;
  std::span<const Q24> coefficients_, shapes_;
  std::size_t coefficient_ = 0;
  std::size_t shape_ = 0;
  std::uint32_t off_ = 0;
};

void print_effort_law(Print& out, const EffortConfig& effort) {
  if (!is_on(effort.law)) {
    out << "  no effort law: the feedforward is that of a steady motion, and there is no disturbance signal\r\n";
    return;
  }
  const std::int32_t delay = MotionWindow<Q24>::delay_of(SamplePeriod<Q24>(kCycleRateHz), effort.view.window_s);
  out << "  motor torque by the motion is the sum of\r\n";
  LawPrinter<true> printer(out, effort.law.coefficients, effort.law.shapes);
  TorqueTerms::for_each<Q24>(printer);
  out << "    it " << (effort.feedforward != 0 ? "is" : "is not")
      << " the feedforward (effort.feedforward); the disturbance is " << static_cast<std::uint32_t>(delay)
      << " ms old and takes as long to show 63 % of a step\r\n";
}

void print_force_law(Print& out, const ForceConfig& force) {
  switch (static_cast<ForceLawKind>(force.law)) {
    case ForceLawKind::kNone:
      out << "  no force law: 'move jointN force=' is refused\r\n";
      return;
    case ForceLawKind::kPreisach:
      out << "  joint torque, tip held: Preisach model (4.4), " << force.grid.levels << " levels from "
          << force.grid.inputs[0] << " to " << force.grid.inputs[force.grid.levels - 1] << " Nm of the motor, "
          << force.grid.force(0, 0) << " to " << force.grid.force(force.grid.levels - 1, force.grid.levels - 1)
          << " Nm of the joint\r\n";
      break;
    case ForceLawKind::kPull:
    case ForceLawKind::kPullPush:
    case ForceLawKind::kBlend:
      out << "  joint torque, tip held: ";
      if (force.law == static_cast<std::int32_t>(ForceLawKind::kBlend)) {
        out << "blend (2.27), " << force.pull_weight << " of pull and " << force.pull_push_weight
            << " of pull-push model";
      } else {
        out << (force.law == 1 ? "pull model (2.17)" : "pull-push model (2.18)-(2.21)");
      }
      out << ", eta_top " << force.eta_top << ", eta_bottom " << force.eta_bottom << ", pretension "
          << force.pretension_nm << " Nm, ratio " << force.ratio << "\r\n";
      break;
  }
  out << "    the motor's own friction " << force.friction_nm << " Nm, offset " << force.offset_nm << " Nm\r\n";
}

}  // namespace

namespace {

void print_status_of(Print& out, const char* law, std::int32_t status) {
  switch (static_cast<LawStatus>(status)) {
    case LawStatus::kProvisional:
      out << "  the " << law
          << " is provisional: it lowers the error on unseen data, but which effects it consists of is not certain; a "
             "longer or richer log may show it\r\n";
      break;
    case LawStatus::kBase:
      out << "  the " << law << " is the base law: nothing was found in the log that lowers its error\r\n";
      break;
    case LawStatus::kConfirmed:
      break;
  }
}

}  // namespace

void print_law_status(Print& out, const AxisConfig& config) {
  print_status_of(out, "law", config.law_status);
  if (is_on(config.effort.law)) {
    print_status_of(out, "effort law", config.effort.status);
  }
}

namespace {

/// Three parts a joint: its law, its effort law and its force law.
class ModelStream final : public PartsStream {
 public:
  std::uint32_t axis = 0;
  std::uint32_t end = 0;  ///< the first joint that is not shown

 private:
  auto print(Session& session, std::uint32_t part) -> bool override;
};

auto ModelStream::print(Session& session, std::uint32_t part) -> bool {
  constexpr std::uint32_t kParts = 3;
  const std::uint32_t joint = axis + part / kParts;
  if (joint >= end) {
    session.ok();
    return false;
  }
  Print& out = session.out();
  const AxisConfig& config = session.machine().config()[joint];
  switch (part % kParts) {
    case 0: {
      out << "joint" << joint << " joint angle q2 is the sum of\r\n";
      print_law_status(out, config);
      LawPrinter<false> printer(out, config.law.coefficients, config.law.shapes);
      for_each_term<Q24>(printer);
      out << "  and " << printer.off() << " terms that are off; 'set joint" << joint
          << ".TERM.NAME' changes one while disarmed\r\n";
      break;
    }
    case 1:
      print_effort_law(out, config.effort);
      break;
    default:
      print_force_law(out, config.force);
      break;
  }
  return true;
}

}  // namespace

void commands::model(Session& session, std::string_view arguments) {
  std::string_view joint = next_word(arguments);
  std::size_t only = 0;
  const bool one = !joint.empty();
  if (one && (!session.parse_axis(joint, only) || !joint.empty())) {
    session.error("unknown_joint", "there is no such joint", "write 'model' or 'model joint0'");
    return;
  }
  auto& stream = session.make<ModelStream>();
  stream.axis = static_cast<std::uint32_t>(only);
  stream.end = one ? stream.axis + 1 : static_cast<std::uint32_t>(session.machine().axes());
  session.answer(stream);
}

}  // namespace capstan
