// The scalar laws of the contacts and hinges, one row each.
#pragma once

#include <array>

#include "erard/model/model.hpp"

namespace erard {

enum class RowKind {
  felt,        // normal of a contact with a felt without mass: its impulse is a function of the compression
  normal,      // Signorini: gap at the end of the step >= 0, impulse >= 0, one of them zero       thesis (5.35)
  stop,        // the same for a felt that reaches its free shape: compression >= 0
  tangential,  // Coulomb: |impulse| <= mu * normal impulse, against the velocity at the end       thesis (5.36)
  hinge,       // dry friction of a joint: |impulse| <= c_d h                                       thesis (4.6)
};

/// One law. Its velocity is measured in m/s, on hinges in rad/s; its impulse in N s, on hinges in N m s.
struct Row {
  RowKind kind = RowKind::normal;
  int index = 0;     // contact (felt, normal, stop, tangential) or coordinate (hinge)
  int normal = -1;   // tangential: row of the normal impulse that bounds it
  double bound = 0;  // tangential: mu [-]; hinge: c_d [N m] or [N]
};

struct RowTable {
  int count = 0;
  std::array<Row, kMaxRows> row;
};

/// Coordinates of a model: one for each body and each felt with mass. At most kMaxCoordinates fit.
inline int count_coordinates(const Model& model) noexcept {
  int count = model.body_count;
  for (int c = 0; c < model.contact_count; ++c) count += is_felt_body(model.contacts[c]) ? 1 : 0;
  return count;
}

/// Rows of a model at most, with everything in play. At most kMaxRows fit.
inline int count_rows(const Model& model) noexcept {
  int count = 0;
  for (int c = 0; c < model.contact_count; ++c)
    count += 1 + (is_felt_body(model.contacts[c]) ? 1 : 0) + (model.contacts[c].friction > 0 ? 1 : 0);
  for (int i = 0; i < model.body_count; ++i) count += model.bodies[i].dry > 0 ? 1 : 0;
  return count;
}

/// All rows of a model, in the order in which they are swept. Contacts and hinges out of play have none.
inline RowTable number_rows(const Model& model) noexcept {
  RowTable table;
  std::array<int, kMaxContacts> normal{};
  const auto add = [&table](const Row& row) noexcept { table.row[table.count++] = row; };
  for (int c = 0; c < model.contact_count; ++c) {
    if (!model.contacts[c].is_active) continue;
    normal[c] = table.count;
    add({is_massless(model.contacts[c]) ? RowKind::felt : RowKind::normal, c, -1, 0});
    if (is_felt_body(model.contacts[c])) add({RowKind::stop, c, -1, 0});
  }
  for (int c = 0; c < model.contact_count; ++c)
    if (model.contacts[c].is_active && model.contacts[c].friction > 0)
      add({RowKind::tangential, c, normal[c], model.contacts[c].friction});
  for (int i = 0; i < model.body_count; ++i)
    if (!model.bodies[i].is_held && model.bodies[i].dry > 0) add({RowKind::hinge, i, -1, model.bodies[i].dry});
  return table;
}

/// Number of the first row of that kind and index, or -1.
inline int find_row(const RowTable& table, RowKind kind, int index) noexcept {
  for (int k = 0; k < table.count; ++k)
    if (table.row[k].kind == kind && table.row[k].index == index) return k;
  return -1;
}

}  // namespace erard
