// Finds the lowest and the highest number around each block of 8 x 8 x 8 cells, and whether some of
// its samples have no value, once for a volume.
layout(local_size_x = 64) in;
layout(std430, binding = 2) writeonly buffer Ranges
{
    int ranges[];
};
shared int low, high, gap;

void main()
{
    uint block = group_number(), t = gl_LocalInvocationIndex;
    if (block >= BLOCK_COUNT)
        return;
    if (t == 0u) {
        low = 0x7fffffff;
        high = int(0x80000000u);
        gap = 0;
    }
    barrier();
    ivec3 first = first_sample(block) - 1;
    int my_low = 0x7fffffff, my_high = int(0x80000000u), my_gap = 0;
    for (int n = int(t); n < 729; n += 64) {
        ivec3 v = first + ivec3(n % 9, n / 9 % 9, n / 81);
        uint bits;
        if (fetch(v, bits)) {
            my_low = min(my_low, key_of(bits));
            my_high = max(my_high, key_of(bits));
        } else {
            my_gap |= is_within(v) ? 3 : 1;
        }
    }
    atomicMin(low, my_low);
    atomicMax(high, my_high);
    atomicOr(gap, my_gap);
    barrier();
    if (t == 0u) {
        ranges[3u * block] = low;
        ranges[3u * block + 1u] = high;
        ranges[3u * block + 2u] = gap & 1;
        if ((gap & 2) != 0)
            atomicOr(totals[GAPS], 1u);
        if (low <= high) {
            atomicMin(totals[LOWEST], uint(low) ^ 0x80000000u);
            atomicMax(totals[HIGHEST], uint(high) ^ 0x80000000u);
        }
    }
}
