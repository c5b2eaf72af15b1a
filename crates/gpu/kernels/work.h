// Work: counts that a thread keeps and adds to those of the call.
#pragma once

#include "tables.h"

// Numbers of the counts in `Job::counts`. The last one is of events for which the CPU engine is to trace the call.
enum { SEGMENTS, SKIPPED, SKIPPED_NEARBY, NOT_RECORDED, LEFT_TO_CPU, COUNTS };

struct Work {
    u32 counts[COUNTS];

    DEVICE void add(int count) { counts[count]++; }

    DEVICE void add_to(const Job &job) const {
        for (int k = 0; k < COUNTS; k++) {
            if (counts[k] > 0) {
                add_shared(job.counts + k, counts[k]);
            }
        }
    }
};
