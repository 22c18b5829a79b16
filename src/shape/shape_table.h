/// Table of the shapes (shape.h).
#pragma once

#include "shape/box.h"
#include "shape/capsule.h"
#include "shape/cylinder.h"
#include "shape/plane.h"
#include "shape/sphere.h"

/// Calls SHAPE(name) for each shape: an enumerator of Shape and a struct of the same name.
#define HAPTIC_CLOTH_SHAPES(SHAPE) SHAPE(Box) SHAPE(Sphere) SHAPE(Cylinder) SHAPE(Capsule) SHAPE(Plane)
