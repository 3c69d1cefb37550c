#include "study/published_curves.hpp"

#include <algorithm>
#include <cmath>

namespace erard::study {
namespace {

Band band(Touch touch, double hammer_speed, std::array<TimingCurve, 2> PublishedGrand::*quantity) {
  Band band{1e9, -1e9};
  for (const PublishedGrand& grand : published_grands()) {
    const double time = (grand.*quantity)[static_cast<std::size_t>(touch)].at(hammer_speed);
    band = {std::min(band.low, time), std::max(band.high, time)};
  }
  return band;
}

}  // namespace

double TimingCurve::at(double hammer_speed) const noexcept {
  return factor * std::pow(hammer_speed, exponent) + offset;
}

const std::array<PublishedGrand, 3>& published_grands() {
  static const std::array<PublishedGrand, 3> grands{
      {{"Steinway C",
        {{{98.57e-3, -0.7147, 0}, {65.19e-3, -0.7268, 0}}},
        {{{19.09e-3, -0.3936, -12.30e-3}, {59.57e-3, -0.1131, -51.19e-3}}},
        {{{1.63e-3, -1.403, 0}, {3.04e-3, -1.581, 0}}}},
       {"Yamaha Disklavier",
        {{{89.41e-3, -0.5959, 0}, {57.43e-3, -0.7748, 0}}},
        {{{14.63e-3, -0.4158, -11.05e-3}, {10.15e-3, -0.6825, -3.74e-3}}},
        {{{2.78e-3, -1.266, 0}, {5.27e-3, -1.384, 0}}}},
       {"Boesendorfer SE290",
        {{{89.96e-3, -0.5595, 0}, {58.39e-3, -0.7377, 0}}},
        {{{11.59e-3, -0.4497, -9.98e-3}, {13.96e-3, -0.3559, -10.15e-3}}},
        {{{3.21e-3, -1.353, 0}, {4.32e-3, -1.404, 0}}}}}};
  return grands;
}

Band published_travel(Touch touch, double speed) { return band(touch, speed, &PublishedGrand::travel); }
Band published_bottom(Touch touch, double speed) { return band(touch, speed, &PublishedGrand::bottom); }
Band published_flight(Touch touch, double speed) { return band(touch, speed, &PublishedGrand::flight); }

}  // namespace erard::study
