/* Finds equal samples by a hash table, and drops all but the first of them. */
#include "formats/cells/merge_samples.h"

#include "core/base/memory.h"

#include <string.h>

static uint64_t mix_hash(uint64_t hash, const void *bytes, size_t size)
{
    const unsigned char *at = bytes;
    for (size_t i = 0; i < size; i += sizeof hash) {
        uint64_t word = 0;
        memcpy(&word, at + i, size - i < sizeof word ? size - i : sizeof word);
        hash = (hash ^ word) * 0x9e3779b97f4a7c15u;
        hash ^= hash >> 32;
    }
    return hash;
}

bool cwi_samples_map(const double *points, const void *values, size_t value_bytes, size_t count,
                     uint32_t *map, size_t *same)
{
    const unsigned char *value = values;
    const size_t point_bytes = 3 * sizeof *points;
    size_t slots = 1;
    while (slots < 2 * count)
        slots *= 2;
    uint32_t *table = cwi_alloc_zeroed(slots, sizeof *table); /* sample + 1, or 0 */
    if (!table)
        return false;
    /* The seed of the hashes is a hash of all points, so no file can be made of samples that
     * collide. */
    const uint64_t seed = mix_hash(0, points, count * point_bytes);
    *same = 0;
    for (size_t n = 0; n < count; n++) {
        const double *point = points + 3 * n;
        const uint64_t hash =
            mix_hash(mix_hash(seed, point, point_bytes), value + n * value_bytes, value_bytes);
        size_t slot = hash & (slots - 1), there = n;
        for (; table[slot]; slot = (slot + 1) & (slots - 1)) {
            const size_t other = table[slot] - 1;
            if (memcmp(point, points + 3 * other, point_bytes) == 0 &&
                memcmp(value + n * value_bytes, value + other * value_bytes, value_bytes) ==
                    0) {
                there = other;
                break;
            }
        }
        table[slot] = (uint32_t)there + 1;
        map[n] = (uint32_t)there;
        *same += there != n;
    }
    cwi_free(table);
    return true;
}

void cwi_samples_drop(double *points, void *values, size_t value_bytes, size_t count,
                      uint32_t *map)
{
    unsigned char *value = values;
    uint32_t left = 0;
    for (size_t n = 0; n < count; n++) {
        if (map[n] < n) { /* the first one was already moved */
            map[n] = map[map[n]];
            continue;
        }
        memmove(points + 3 * left, points + 3 * n, 3 * sizeof *points);
        memmove(value + left * value_bytes, value + n * value_bytes, value_bytes);
        map[n] = left++;
    }
}
