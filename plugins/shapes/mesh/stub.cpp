// SPDX-License-Identifier: MIT
// Stub of the shape for builds without Embree or assimp. Creating it throws an error that names the missing packages.
#include "stub.hpp"

#include "shapes/mesh/options.hpp"

#include <palpate/shape.hpp>

PALPATE_STUB_PLUGIN(palpate::Shape, palpate::shapes::MeshOptions, "mesh",
                    "triangles from a file by Embree and assimp, which this build does not have")
