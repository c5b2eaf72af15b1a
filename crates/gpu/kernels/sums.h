// Sums: exact fluxes, as integers of 128 bits in units of 2^-62 of a high part.
#pragma once

#include "work.h"

// Adds a flux to an entry of a batch. What is below one unit is cut off. A flux that is no number, or too large, is left to the CPU engine.
DEVICE_CALL void add_flux(const Job &job, u32 entry, u32 batch, double flux) {
    const double scaled = flux * job.scale;
    if (!(scaled < 4611686018427387904.0 && scaled > -4611686018427387904.0)) {
        add_shared(job.counts + LEFT_TO_CPU, 1);
        return;
    }
    const i64 high = (i64)scaled;
    const i64 low = (i64)((scaled - (double)high) * 4611686018427387904.0);
    // high 2^62 + low, as two words of a number in two's complement
    const u64 shifted = (u64)high << 62;
    const u64 word = shifted + (u64)low;
    const u64 carry = (word < shifted ? 1 : 0) + (u64)(low >> 63) + (u64)(high >> 2);
    u64 *sum = job.sums + 2 * ((u64)entry * job.batches + batch);
    const u64 before = add_shared(sum, word);
    add_shared(sum + 1, carry + (before + word < before ? 1 : 0));
}
