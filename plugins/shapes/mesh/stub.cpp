// SPDX-License-Identifier: MIT
// The shape in builds without Embree or assimp. It only reports what this build lacks.
#include "stub.hpp"

#include "shapes/mesh/options.hpp"

#include <palpate/shape.hpp>

PALPATE_STUB_PLUGIN(palpate::Shape, palpate::shapes::MeshOptions, "mesh",
                    "triangles from a file by Embree and assimp, which this build does not have")
