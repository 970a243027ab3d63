// SPDX-License-Identifier: MIT
// The laws that shape.hpp states.
#pragma once

#include <palpate/random.hpp>
#include <palpate/shape.hpp>

namespace palpate::test {

/// Uniform over the sphere.
Eigen::Vector3d random_direction(Random& random);

/// Fails the test where a law is broken.
void check_shape_laws(const Shape& shape);

}  // namespace palpate::test
