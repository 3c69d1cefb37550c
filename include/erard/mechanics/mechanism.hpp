// The model with its coordinates and its laws numbered: what every later floor walks over.
#pragma once

#include <algorithm>
#include <array>

#include <Eigen/Core>

#include "erard/mechanics/rows.hpp"

namespace erard {

using CoordinateVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxCoordinates, 1>;
using CoordinateMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor, kMaxCoordinates, kMaxCoordinates>;

/// Coordinates that move the two sides of a contact against each other: the branches of its bodies up to where they
/// meet, and the coordinate of its felt where that has mass. Ascending.
struct ContactPath {
  int count = 0;
  std::array<int, kMaxBodies + 1> coordinate{};
  std::array<double, kMaxBodies + 1> sign{};  // +1 on B's branch, -1 on A's; 0 for the felt
};
using PathValues = std::array<double, kMaxBodies + 1>;  // one for each coordinate of a path

/// Ancestors of each coordinate in a tree of coordinates, nearest first.
struct AncestorTable {
  int size = 0;
  std::array<int, kMaxCoordinates> count{};
  std::array<std::array<int, kMaxCoordinates>, kMaxCoordinates> list{};
};

/// Coordinates of a model: bodies first, then felts with mass. parent[] is the tree of coordinates, in which every felt
/// is a leaf; the mass matrix has entries only between a coordinate and those above it.
struct Mechanism {
  Model model;
  int coordinate_count = 0;
  std::array<int, kMaxCoordinates> parent{};        // coordinate above, or kGround
  AncestorTable elimination;                        // of the iteration matrix: that tree with what couples its branches
  std::array<ContactPath, kMaxContacts> path{};     // of each contact
  std::array<int, kMaxContacts> felt_coordinate{};  // of each contact with a felt body, or -1
  std::array<int, kMaxContacts> normal_row{};       // of each contact, or -1 out of play
  RowTable rows;
  bool has_rigid_contacts = false;  // contacts in play without felt
  double total_mass = 0;            // [kg]

  int body_count() const noexcept { return model.body_count; }
  int contact_count() const noexcept { return model.contact_count; }
  bool is_felt(int coordinate) const noexcept { return coordinate >= model.body_count; }
};

/// Body that carries the felt of this contact.
inline int carrier(const Contact& contact) noexcept {
  return contact.felt.is_carried_by_a ? contact.body_a : contact.body_b;
}

/// Path of contact c.
inline ContactPath find_path(const Mechanism& mechanism, int c) noexcept {
  const Contact& contact = mechanism.model.contacts[c];
  std::array<double, kMaxCoordinates> sign{};
  for (int j = contact.body_b; j != kGround; j = mechanism.parent[j]) sign[j] += 1;
  for (int j = contact.body_a; j != kGround; j = mechanism.parent[j]) sign[j] -= 1;  // 0 where both branches are one
  ContactPath path;
  for (int j = 0; j < mechanism.coordinate_count; ++j) {
    if (sign[j] == 0 && j != mechanism.felt_coordinate[c]) continue;
    path.coordinate[path.count] = j;
    path.sign[path.count++] = sign[j];
  }
  return path;
}

/// Elimination tree of M with one clique for each felt without mass (its path), eliminated from the last coordinate to
/// the first: entries of the factors stand only between a coordinate and its ancestors.
/// T. Davis, Direct Methods for Sparse Linear Systems (2006), 4.1, in reverse order.
inline AncestorTable find_elimination_tree(const Mechanism& mechanism) noexcept {
  const int n = mechanism.coordinate_count;
  std::array<std::array<bool, kMaxCoordinates>, kMaxCoordinates> is_coupled{};  // [i][j], j < i
  for (int i = 0; i < n; ++i)
    for (int j = mechanism.parent[i]; j != kGround; j = mechanism.parent[j]) is_coupled[i][j] = true;
  for (int c = 0; c < mechanism.model.contact_count; ++c) {
    if (!is_massless(mechanism.model.contacts[c])) continue;
    const ContactPath& path = mechanism.path[c];
    for (int a = 0; a < path.count; ++a)
      for (int b = 0; b < a; ++b) is_coupled[path.coordinate[a]][path.coordinate[b]] = true;
  }
  std::array<int, kMaxCoordinates> above{};
  for (int i = n - 1; i >= 0; --i) {
    above[i] = kGround;
    for (int j = 0; j < i; ++j)
      if (is_coupled[i][j]) above[i] = j;
    // once i is eliminated, what it was coupled to is coupled to the next above
    for (int j = 0; j < above[i]; ++j) is_coupled[above[i]][j] = is_coupled[above[i]][j] || is_coupled[i][j];
  }
  AncestorTable table;
  table.size = n;
  for (int i = 0; i < n; ++i)
    for (int j = above[i]; j != kGround; j = above[j]) table.list[i][table.count[i]++] = j;
  return table;
}

/// Numbers coordinates and rows. The model must be valid: parents before children, no more bodies, contacts, coordinates and
/// rows than capacity.hpp has room for.
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
    mechanism.felt_coordinate[i] = is_felt_body(contact) ? next : -1;
    if (!is_felt_body(contact)) continue;
    mechanism.parent[next++] = carrier(contact);
    mechanism.total_mass += contact.felt.mass;
  }
  mechanism.coordinate_count = next;
  for (int c = 0; c < model.contact_count; ++c) mechanism.path[c] = find_path(mechanism, c);
  mechanism.elimination = find_elimination_tree(mechanism);
  mechanism.rows = number_rows(model);
  mechanism.normal_row.fill(-1);
  for (int k = 0; k < mechanism.rows.count; ++k) {
    const Row& row = mechanism.rows.row[k];
    if (row.kind == RowKind::felt || row.kind == RowKind::normal) mechanism.normal_row[row.index] = k;
    if (row.kind == RowKind::normal && !model.contacts[row.index].has_felt) mechanism.has_rigid_contacts = true;
  }
  return mechanism;
}

}  // namespace erard
