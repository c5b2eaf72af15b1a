// Vectors: three components, and operations in the order in which the Rust engine computes them.
#pragma once

#include "portable.h"

struct Vec3 {
    double x, y, z;
};

DEVICE Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }

DEVICE Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }

DEVICE Vec3 operator-(Vec3 a) { return {-a.x, -a.y, -a.z}; }

DEVICE Vec3 operator*(double t, Vec3 a) { return {t * a.x, t * a.y, t * a.z}; }

DEVICE double dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

// Sum of the magnitudes of the components.
DEVICE double extent_of(Vec3 a) { return fabs(a.x) + fabs(a.y) + fabs(a.z); }

// A direction turned about the vertical by the angle of cosine `cos` and sine `sin`.
DEVICE Vec3 turned(Vec3 a, double cos, double sin) { return {cos * a.x - sin * a.y, sin * a.x + cos * a.y, a.z}; }

// A direction with some axes mirrored: those along x by bit 0, along y by bit 1.
DEVICE Vec3 mirrored(Vec3 a, u32 axes) { return {axes & 1 ? -a.x : a.x, axes & 2 ? -a.y : a.y, a.z}; }

// A ray in tile coordinates, the sign of its half space, and the axes along which it has been mirrored on its way.
struct Ray {
    Vec3 o, d;
    double q;
    u32 flips;
};

DEVICE Vec3 at(const Ray &ray, double t) { return ray.o + t * ray.d; }
