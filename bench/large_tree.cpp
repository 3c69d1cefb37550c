#include "large_tree.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "erard/mechanics/dynamics.hpp"

namespace erard::bench {
namespace {

using Triplets = std::vector<Eigen::Triplet<double>>;

Vector2 point_rate_of(const Body& body, const Frame& frame, const Vector2& point) {
  return body.joint == JointKind::hinge ? perp(point - frame.origin) : frame.slide;
}

constexpr int kMostTouches = 500;  // contacts that the bench asks for

struct Lever {
  int coordinate;
  double value;
};

/// direction . d(p_B - p_A)/dx along the path between the two bodies.
std::vector<Lever> levers(const LargeTree& tree, const std::vector<Frame>& frames, const Touch& touch,
                          const Vector2& direction) {
  std::vector<int> on_a, on_b;
  for (int j = touch.body_a; j != kGround; j = tree.bodies[j].parent) on_a.push_back(j);
  for (int j = touch.body_b; j != kGround; j = tree.bodies[j].parent) on_b.push_back(j);
  while (!on_a.empty() && !on_b.empty() && on_a.back() == on_b.back()) {
    on_a.pop_back();
    on_b.pop_back();
  }
  std::vector<Lever> path;
  const auto add = [&](const std::vector<int>& branch, double sign) {
    for (const int j : branch)
      path.push_back({j, sign * direction.dot(point_rate_of(tree.bodies[j], frames[j], touch.point))});
  };
  add(on_b, 1);
  add(on_a, -1);
  return path;
}

SparseMatrix compressed(int rows, int columns, const Triplets& entries) {
  SparseMatrix matrix(rows, columns);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

Triplets mass_entries(const LargeTree& tree) {
  const int n = tree.size();
  const std::vector<Frame> frames = place(tree);
  std::vector<Inertia> composite;
  for (int i = 0; i < n; ++i) {
    const Body& body = tree.bodies[i];
    composite.push_back({body.mass, body.mass * frames[i].turned(body.centre), body.inertia});
  }
  Triplets entries;
  for (int i = n - 1; i >= 0; --i) {
    const Body& body = tree.bodies[i];
    const bool is_hinge = body.joint == JointKind::hinge;
    const Inertia& own = composite[i];
    // momentum and moment of momentum of the subtree per unit rate, carried on to each joint above
    const Vector2 l = is_hinge ? perp(own.moment) : Vector2(own.mass * frames[i].slide);
    double k = is_hinge ? own.inertia : cross(own.moment, frames[i].slide);
    entries.emplace_back(i, i, is_hinge ? own.inertia : own.mass);
    Vector2 pivot = frames[i].origin;
    for (int j = body.parent; j != kGround; j = tree.bodies[j].parent) {
      k += cross(pivot - frames[j].origin, l);
      pivot = frames[j].origin;
      const double value = tree.bodies[j].joint == JointKind::hinge ? k : frames[j].slide.dot(l);
      entries.emplace_back(i, j, value);
      entries.emplace_back(j, i, value);
    }
    if (body.parent == kGround) continue;
    const Vector2 r = frames[i].origin - frames[body.parent].origin;
    Inertia& holder = composite[body.parent];
    holder.mass += own.mass;
    holder.moment += own.moment + own.mass * r;
    holder.inertia += own.inertia + 2 * r.dot(own.moment) + own.mass * r.squaredNorm();
  }
  return entries;
}

SparseMatrix directions(const LargeTree& tree, const std::vector<Touch>& touches, const std::vector<Vector2>& along) {
  const std::vector<Frame> frames = place(tree);
  Triplets entries;
  const auto each = along.size() / std::max<std::size_t>(1, touches.size());
  for (std::size_t k = 0; k < along.size(); ++k)
    for (const Lever& lever : levers(tree, frames, touches[k / each], along[k]))
      entries.emplace_back(lever.coordinate, static_cast<int>(k), lever.value);
  return compressed(tree.size(), static_cast<int>(along.size()), entries);
}

/// A body of wood as it is found in an action: a few centimetres, a few grams.
class RandomBodies {
 public:
  explicit RandomBodies(unsigned seed) : random_(seed) {}

  double between(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  int below(int count) { return std::uniform_int_distribution<int>(0, count - 1)(random_); }

  Body body(int parent) {
    Body body;
    body.parent = parent;
    body.origin = {between(-0.05, 0.05), between(-0.05, 0.05)};
    body.mass = between(0.005, 0.05);
    body.centre = {between(-0.03, 0.03), between(-0.03, 0.03)};
    body.inertia = body.mass * (body.centre.squaredNorm() + between(1e-4, 4e-4));
    return body;
  }
  Vector2 direction() { return unit_vector(between(-std::numbers::pi, std::numbers::pi)); }

  /// Hangs one more body on that parent, at any angle.
  void grow(LargeTree& tree, int parent) {
    tree.bodies.push_back(body(parent));
    tree.x.push_back(between(-3, 3));
  }

 private:
  std::mt19937 random_;
};

/// A touch to every four bodies, as many as the bench asks for.
/// @param make  called as make(frames)
template <typename MakeTouch>
void add_touches(LargeTree& tree, const MakeTouch& make) {
  const std::vector<Frame> frames = place(tree);
  for (int k = 0; k < std::min(tree.size() / 4, kMostTouches); ++k) tree.touches.push_back(make(frames));
}

}  // namespace

std::vector<Frame> place(const LargeTree& tree) {
  std::vector<Frame> frames(tree.bodies.size());
  for (int i = 0; i < tree.size(); ++i) {
    const Body& body = tree.bodies[i];
    const Frame parent = body.parent == kGround ? Frame{} : frames[body.parent];
    Frame& frame = frames[i];
    frame.origin = parent.placed(body.origin);
    frame.angle = parent.angle;
    if (body.joint == JointKind::hinge) {
      frame.angle += tree.x[i];
    } else {
      frame.slide = parent.turned(body.direction.unit_vector());
      frame.origin += tree.x[i] * frame.slide;
    }
    frame.x_axis = unit_vector(frame.angle);
  }
  return frames;
}

SparseMatrix mass_matrix(const LargeTree& tree) { return compressed(tree.size(), tree.size(), mass_entries(tree)); }

SparseMatrix iteration_matrix(const LargeTree& tree) {
  Triplets entries = mass_entries(tree);
  for (std::size_t k = 0, count = entries.size(); k < count; ++k)
    if (entries[k].row() == entries[k].col())
      entries.emplace_back(entries[k].row(), entries[k].row(), tree.pull * entries[k].value());
  const std::vector<Frame> frames = place(tree);
  for (const Touch& touch : tree.touches) {
    if (touch.loss == 0) continue;
    const std::vector<Lever> path = levers(tree, frames, touch, touch.felt);
    for (const Lever& a : path)
      for (const Lever& b : path) entries.emplace_back(a.coordinate, b.coordinate, touch.loss * a.value * b.value);
  }
  return compressed(tree.size(), tree.size(), entries);
}

SparseMatrix row_directions(const LargeTree& tree) {
  std::vector<Vector2> along;
  for (const Touch& touch : tree.touches) along.push_back(touch.row);
  if (along.size() > kMostTouches) along.resize(kMostTouches);
  std::vector<Touch> touches(tree.touches.begin(), tree.touches.begin() + static_cast<std::ptrdiff_t>(along.size()));
  return directions(tree, touches, along);
}

SparseMatrix closure_directions(const LargeTree& tree) {
  std::vector<Vector2> along;
  for (std::size_t k = 0; k < tree.closures.size(); ++k) {
    along.push_back(Vector2::UnitX());
    along.push_back(Vector2::UnitY());
  }
  return directions(tree, tree.closures, along);
}

LargeTree bush(int size, unsigned seed) {
  RandomBodies random(seed);
  LargeTree tree;
  tree.pull = 0.01;
  std::vector<std::vector<int>> children(static_cast<std::size_t>(size));
  for (int i = 0; i < size; ++i) {
    random.grow(tree, i == 0 ? kGround : random.below(i));
    if (i > 0) children[tree.bodies[i].parent].push_back(i);
  }
  add_touches(tree, [&](const std::vector<Frame>& frames) {
    Touch touch;
    touch.body_b = 1 + random.below(size - 1);
    // a sibling, a child of the grandparent, or the ground
    const int up = tree.bodies[touch.body_b].parent;
    const int over = random.below(2) == 0 || tree.bodies[up].parent == kGround ? up : tree.bodies[up].parent;
    const auto& near = children[over];
    touch.body_a = near[static_cast<std::size_t>(random.below(static_cast<int>(near.size())))];
    if (touch.body_a == touch.body_b) touch.body_a = kGround;
    touch.point = frames[touch.body_b].placed(tree.bodies[touch.body_b].centre);
    touch.felt = random.direction();
    touch.row = perp(touch.felt);
    touch.loss = random.between(0.005, 0.05);  // a felt of 1e5 N/m over steps of 1/4 ms and theta = 1/2: 3 g
    return touch;
  });
  return tree;
}

LargeTree chain(int size, unsigned seed) {
  RandomBodies random(seed);
  LargeTree tree;
  tree.pull = 0.01;
  for (int i = 0; i < size; ++i) random.grow(tree, i - 1);
  add_touches(tree, [&](const std::vector<Frame>& frames) {
    Touch touch;
    touch.body_b = random.below(size);
    touch.point = frames[touch.body_b].origin + 0.02 * random.direction();
    touch.row = random.direction();
    return touch;
  });
  return tree;
}

LargeTree felt_stack(int size) {
  LargeTree tree;
  tree.pull = 0.01;
  for (int i = 0; i < size; ++i) {
    Body felt;
    felt.joint = JointKind::prismatic;
    felt.direction = std::numbers::pi / 2;
    felt.mass = 1.5e-5;
    felt.origin = {0, 0.002 * i};
    tree.bodies.push_back(felt);
    tree.x.push_back(0);
    Touch touch;
    touch.body_a = i - 1;  // the lowest stands on the ground
    touch.body_b = i;
    touch.point = felt.origin;
    touch.loss = 3e-3;  // 1e5 N/m over steps of 1/4 ms, theta = 1/2
    touch.row = touch.felt;
    tree.touches.push_back(touch);
  }
  return tree;
}

LargeTree linkages(int count, unsigned seed) {
  RandomBodies random(seed);
  LargeTree tree;
  tree.pull = 0.01;
  tree.bodies.push_back(random.body(kGround));
  tree.bodies[0].joint = JointKind::prismatic;
  tree.bodies[0].mass = 40;
  tree.x.push_back(0);
  for (int k = 0; k < count; ++k)
    for (int i = 0; i < 3; ++i) random.grow(tree, i == 0 ? 0 : tree.size() - 1);
  const std::vector<Frame> frames = place(tree);
  for (int k = 0; k < count; ++k) {
    Touch closure;
    closure.body_a = 0;
    closure.body_b = 3 * k + 3;
    closure.point = frames[closure.body_b].placed(2 * tree.bodies[closure.body_b].centre);
    tree.closures.push_back(closure);
  }
  return tree;
}

}  // namespace erard::bench
