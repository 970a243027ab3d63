// SPDX-License-Identifier: MIT
// The shape of a build without Embree or without assimp.
#include "absent.hpp"

#include "shapes/mesh/options.hpp"

#include <palpate/shape.hpp>

PALPATE_ABSENT_PLUGIN(palpate::Shape, palpate::shapes::MeshOptions, "mesh",
                      "triangles from a file by Embree and assimp, which this build does not have")
