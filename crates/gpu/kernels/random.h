// Random numbers: functions of seed, surface, path and step, by Threefry-2x64 with 13 rounds.
//
// Source: Salmon, Moraes, Dror and Shaw, Parallel Random Numbers: As Easy as 1, 2, 3, Proc. SC11 (2011).
#pragma once

#include "tables.h"

// Purposes of the random numbers of a step.
enum { USE_START, USE_INTERACTION, USE_DIFFUSE, USE_SHADOW };

DEVICE u64 rotated(u64 word, int digits) { return word << digits | word >> (64 - digits); }

// Two numbers in [0, 1).
struct Pair {
    double first, second;
};

DEVICE double unit(u64 word) { return (double)(i64)(word >> 11) * (1.0 / 9007199254740992.0); }

DEVICE Pair threefry(const u64 key[2], u64 x, u64 y) {
    const int rotations[8] = {16, 42, 12, 31, 16, 32, 24, 21};
    const u64 keys[3] = {key[0], key[1], 0x1bd11bdaa9fc1a22ULL ^ key[0] ^ key[1]};
    x += keys[0];
    y += keys[1];
    for (int round = 0; round < 13;) {
        x += y;
        y = rotated(y, rotations[round % 8]) ^ x;
        round++;
        if (round % 4 == 0) {
            const int injection = round / 4;
            x += keys[injection % 3];
            y += keys[(injection + 1) % 3] + (u64)injection;
        }
    }
    return {unit(x), unit(y)};
}

// Pair number `pair` of a step of path number `ray` of the call: `number` interactions so far, `events` bit by bit.
DEVICE_CALL Pair random_pair(const Job &job, u32 ray, u32 number, u32 events, u64 use, u64 pair) {
    const u64 path = job.first_path + ray;
    return threefry(job.key, path | pair << 56 | use << 60, (u64)number | (u64)events << 32);
}
