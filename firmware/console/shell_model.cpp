// SPDX-License-Identifier: Apache-2.0
// The shell's view of the law: what it adds up, term by term.
#include <algorithm>

#include "capstan/firmware/console/shell_commands.hpp"

namespace capstan {
namespace {

/// Walks the catalogue in its order and prints the terms that are on, with their equations and parameters.
class LawPrinter {
 public:
  LawPrinter(Print& out, const LawParameters<Q24>& law) : out_(out), law_(law) {}

  template <typename Term>
  void operator()() {
    const auto coefficients = std::span(law_.coefficients).subspan(coefficient_, kCoefficientsOf<Term>);
    const auto shapes = std::span(law_.shapes).subspan(shape_, kShapesOf<Term>);
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
    out_ << "  " << Term::kInfo.name << ": " << Term::kInfo.equation << " " << Term::kInfo.source << "\r\n";
    for (std::size_t i = 0; i < coefficients.size(); ++i) {
      if (one_at_a_time<Term>() && !on(coefficients[i])) {
        continue;  // of a table's knots those in use
      }
      print(Term::kInfo.coefficients[i].name, coefficients[i], Term::kInfo.coefficients[i].unit,
            Term::kInfo.coefficients[i].doc);
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
  void print(const char* name, Q24 value, const char* unit, const char* doc) {
    out_ << "    " << name << ' ' << value;
    if (std::string_view(unit) != "1") {
      out_ << ' ' << unit;
    }
    out_ << "  " << doc << "\r\n";
  }

  Print& out_;
  const LawParameters<Q24>& law_;
  std::size_t coefficient_ = 0;
  std::size_t shape_ = 0;
  std::uint32_t off_ = 0;
};

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
      out << "  joint torque, tip held: " << (force.law == 1 ? "pull model (2.17)" : "pull-push model (2.18)-(2.21)")
          << ", eta_top " << force.eta_top << ", eta_bottom " << force.eta_bottom << ", pretension "
          << force.pretension_nm << " Nm, ratio " << force.ratio << "\r\n";
      break;
  }
  out << "    the motor's own friction " << force.friction_nm << " Nm, offset " << force.offset_nm << " Nm\r\n";
}

}  // namespace

void print_law_status(Print& out, const AxisConfig& config) {
  switch (static_cast<LawStatus>(config.law_status)) {
    case LawStatus::kProvisional:
      out << "  the law is provisional: it lowers the error on data it has not seen, and what it is made of is not "
             "certain; a longer or richer log may tell\r\n";
      break;
    case LawStatus::kBase:
      out << "  the law is the base law: nothing was found in the log that lowers its error\r\n";
      break;
    case LawStatus::kConfirmed:
      break;
  }
}

void ShellCommands::model(Shell& shell, std::string_view arguments) {
  std::string_view joint = next_word(arguments);
  std::size_t only = 0;
  const bool one = !joint.empty();
  if (one && (!shell.parse_axis(joint, only) || !joint.empty())) {
    shell.error("unknown_joint", "there is no such joint", "write 'model' or 'model joint0'");
    return;
  }
  for (std::size_t axis = one ? only : 0; axis < (one ? only + 1 : shell.machine_.axes()); ++axis) {
    shell.out_ << "joint" << static_cast<std::uint32_t>(axis) << " joint angle q2 is the sum of\r\n";
    print_law_status(shell.out_, shell.machine_.config()[axis]);
    LawPrinter printer(shell.out_, shell.machine_.config()[axis].law);
    for_each_term<Q24>(printer);
    shell.out_ << "  and " << printer.off() << " terms that are off; 'set joint" << static_cast<std::uint32_t>(axis)
               << ".TERM.NAME' changes one while disarmed\r\n";
    print_force_law(shell.out_, shell.machine_.config()[axis].force);
  }
  shell.ok();
}

}  // namespace capstan
