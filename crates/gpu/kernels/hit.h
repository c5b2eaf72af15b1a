// Hit: the first facet that a ray meets. Equal parameters are decided by the number of the facet, as by brute force.
#pragma once

#include "tables.h"
#include "vectors.h"

DEVICE u64 facet_number(int ix, int iy, bool is_upper) { return (u64)iy << 32 | (u64)ix << 1 | (is_upper ? 1 : 0); }

DEVICE int column_of(u64 facet) { return (int)((u32)facet >> 1); }

DEVICE int row_of(u64 facet) { return (int)(facet >> 32); }

// Number of the cell at a place along an axis of `count` cells.
DEVICE int cell_at(double place, int count) { return (int)place < count ? (int)place : count - 1; }

struct Hit {
    double t;
    u64 facet;

    DEVICE static Hit none() { return {INFINITE, ~0ULL}; }

    DEVICE bool is_none() const { return facet == ~0ULL; }

    DEVICE void keep(double at, u64 other) {
        if (at < t || (at == t && other < facet)) {
            t = at;
            facet = other;
        }
    }
};
