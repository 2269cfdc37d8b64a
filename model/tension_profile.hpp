// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "capstan/model/tendon.hpp"

namespace capstan {

/// The tension along one tendon whose output end is held, (2.4)-(2.10): what the input end does travels along it as a
/// slip front, and beyond the front the past remains. Kept exactly, as pieces T = amplitude exp(-eta phi slope) between
/// the fronts of past reversals; a front that goes farther than an older one wipes it out. Host only.
class TensionProfile {
 public:
  static constexpr std::size_t kMaxPieces = 64;

  /// Evenly tensioned, N. @pre the tendon's numbers and the tension are finite and not negative
  TensionProfile(const Tendon& tendon, double tension) : tendon_(tendon) { pieces_[0] = {1.0, tension, 0.0}; }

  /// Brings the input end to a tension, N. Zero and less make the tendon slack in its whole length.
  void pull_to(double tension) {
    if (!(tension > 0.0)) {
      count_ = 1;
      pieces_[0] = {1.0, 0.0, 0.0};
      front_ = 1.0;
      return;
    }
    const double before = at(0.0);
    if (tension == before) {
      return;
    }
    const double slope = tension > before ? 1.0 : -1.0;
    std::size_t met = 0;
    front_ = 1.0;
    for (; met < count_; ++met) {
      const double meeting = meeting_with(pieces_[met], tension, slope);
      if (meeting < pieces_[met].end) {
        front_ = meeting;
        break;
      }
    }
    replace(met, {front_, tension, slope});
  }

  /// Tension at phi, 0 at the input to 1 at the output, N.
  [[nodiscard]] auto at(double phi) const -> double {
    std::size_t i = 0;
    while (i + 1 < count_ && phi > pieces_[i].end) {
      ++i;
    }
    return value(pieces_[i], phi);
  }
  /// phi_w of (2.6): how far the last motion of the input end has come.
  [[nodiscard]] auto front() const -> double { return front_; }
  /// Integral of the tension over phi, N. Over Kn it is the elongation, so (2.10) is the difference of two of these.
  [[nodiscard]] auto integral() const -> double {
    double sum = 0.0;
    double begin = 0.0;
    for (std::size_t i = 0; i < count_; ++i) {
      const double length = pieces_[i].end - begin;
      sum += value(pieces_[i], begin) * length * mean_decay(tendon_.eta * pieces_[i].slope * length);
      begin = pieces_[i].end;
    }
    return sum;
  }
  [[nodiscard]] auto elongation() const -> double { return integral() / tendon_.stiffness; }
  /// Past fronts that were dropped because the memory was full; each changed the profile next to the input end.
  [[nodiscard]] auto dropped() const -> std::uint32_t { return dropped_; }

 private:
  struct Piece {
    double end;        ///< phi
    double amplitude;  ///< tension continued to phi = 0, N
    double slope;      ///< +1 falls toward the output, -1 rises, 0 even
  };

  [[nodiscard]] auto value(const Piece& piece, double phi) const -> double {
    return piece.amplitude * std::exp(-tendon_.eta * piece.slope * phi);
  }
  /// Where the new curve has come to an old piece's; beyond every end if they part.
  [[nodiscard]] auto meeting_with(const Piece& piece, double tension, double slope) const -> double {
    const double rate = tendon_.eta * (slope - piece.slope);
    return rate != 0.0 && piece.amplitude > 0.0 ? std::log(tension / piece.amplitude) / rate : 2.0;
  }
  /// The pieces before `met` give way to one.
  void replace(std::size_t met, const Piece& piece) {
    if (met == 0 && count_ == kMaxPieces) {
      met = 1;  // the innermost loop is the smallest there is
      ++dropped_;
    }
    const auto first = pieces_.begin() + static_cast<std::ptrdiff_t>(met);
    const auto last = pieces_.begin() + static_cast<std::ptrdiff_t>(count_);
    const std::size_t kept = count_ - met;
    if (met == 0) {
      std::copy_backward(first, last, last + 1);
    } else {
      std::copy(first, last, pieces_.begin() + 1);
    }
    pieces_[0] = piece;
    count_ = kept + 1;
  }

  Tendon tendon_;
  std::array<Piece, kMaxPieces> pieces_{};
  std::size_t count_ = 1;
  double front_ = 0.0;
  std::uint32_t dropped_ = 0;
};

}  // namespace capstan
