// The model with its coordinates and its laws numbered: what every later floor walks over.
#pragma once

#include <array>

#include <Eigen/Core>

#include "erard/mechanics/rows.hpp"

namespace erard {

using CoordinateVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxCoordinates, 1>;
using CoordinateMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxCoordinates, kMaxCoordinates>;

/// Coordinates of a model: bodies first, then felts. parent[] is the tree of coordinates, in which every felt is a leaf;
/// the mass matrix has entries only between a coordinate and those above it.
struct Mechanism {
  Model model;
  int coordinate_count = 0;
  std::array<int, kMaxCoordinates> parent{};        // coordinate above, or kGround
  std::array<int, kMaxContacts> felt_coordinate{};  // of each contact, or -1
  RowTable rows;
  double total_mass = 0;  // [kg]

  int body_count() const noexcept { return model.body_count; }
  int contact_count() const noexcept { return model.contact_count; }
  bool is_felt(int coordinate) const noexcept { return coordinate >= model.body_count; }
};

/// Body that carries the felt of this contact.
inline int carrier(const Contact& contact) noexcept {
  return contact.felt.is_carried_by_a ? contact.body_a : contact.body_b;
}

/// Numbers coordinates and rows. The model must be valid: parents before children, counts within capacity.
inline Mechanism build_mechanism(const Model& model) noexcept {
  Mechanism mechanism;
  mechanism.model = model;
  int next = 0;
  for (; next < model.body_count; ++next) {
    mechanism.parent[next] = model.bodies[next].parent;
    mechanism.total_mass += model.bodies[next].mass;
  }
  for (int i = 0; i < model.contact_count; ++i) {
    const Contact& contact = model.contacts[i];
    mechanism.felt_coordinate[i] = contact.has_felt ? next : -1;
    if (!contact.has_felt) continue;
    mechanism.parent[next++] = carrier(contact);
    mechanism.total_mass += contact.felt.mass;
  }
  mechanism.coordinate_count = next;
  mechanism.rows = number_rows(model);
  return mechanism;
}

}  // namespace erard
