// Work: counts that a thread keeps and adds to those of the call.
#pragma once

#include "tables.h"

// Numbers of the counts in `Job::counts`.
enum { SEGMENTS, SKIPPED, SKIPPED_NEARBY, NOT_RECORDED, WITHOUT_ROOM, COUNTS };

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
