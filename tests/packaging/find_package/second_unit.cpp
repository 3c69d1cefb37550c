// Includes everything once more: a function that forgot to be inline does not link.
#include <erard/erard.hpp>

int coordinates_of(const erard::Model& model) { return erard::build_mechanism(model).coordinate_count; }
