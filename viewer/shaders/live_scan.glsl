// Sums of all entries before each one, in three steps: of 1024 entries a group, of groups, and both
// together. With BLOCKS_STEP an entry is a block that the surface may cross, and what comes out is the
// list of these; else an entry is a listed block with its vertices and triangles.
layout(local_size_x = 256) in;
layout(std430, binding = 2) readonly buffer Ranges
{
    int ranges[];
};
layout(std430, binding = 3) buffer Slots
{
    uint slots[];
};
layout(std430, binding = 4) buffer Active
{
    uint active_blocks[];
};
layout(std430, binding = 6) buffer Counts
{
    uvec2 counts[];
};
layout(std430, binding = 7) buffer Bases
{
    uvec2 bases[];
};
layout(std430, binding = 8) buffer Sums
{
    uvec2 sums[];
};
shared uvec2 part[256];

#ifdef BLOCKS_STEP
uint entry_count()
{
    return BLOCK_COUNT;
}

uvec2 entry(uint n)
{
    int low = ranges[3u * n], high = ranges[3u * n + 1u];
    if (low > high) // no values
        return uvec2(0u);
    bool above = !NONE_ABOVE && high >= LIMIT, below = NONE_ABOVE || low < LIMIT;
    bool in_some = INVERT ? below : above;
    bool out_some = ranges[3u * n + 2u] != 0 || (INVERT ? above : below);
    return uvec2(in_some && out_some ? 1u : 0u, 0u);
}
#else
uint entry_count()
{
    return min(totals[ACTIVE], SLOT_CAPACITY);
}

uvec2 entry(uint n)
{
    return counts[n];
}
#endif

// Returns the sum of all threads before this one, and of all.
uvec2 scan_group(uvec2 mine, out uvec2 all_of_them)
{
    uint t = gl_LocalInvocationIndex;
    part[t] = mine;
    barrier();
    for (uint step = 1u; step < 256u; step *= 2u) {
        uvec2 before = t >= step ? part[t - step] : uvec2(0u);
        barrier();
        part[t] += before;
        barrier();
    }
    all_of_them = part[255];
    uvec2 sum = part[t] - mine;
    barrier();
    return sum;
}

void set_dispatch(uint at, uint groups)
{
    totals[at] = min(groups, GROUPS_X);
    totals[at + 1u] = (groups + GROUPS_X - 1u) / GROUPS_X;
    totals[at + 2u] = 1u;
}

void main()
{
    uint t = gl_LocalInvocationIndex, count = entry_count();
    uvec2 whole;
#ifdef TOP_STEP
    uint groups = (count + SCAN - 1u) / SCAN;
    uvec2 before = uvec2(0u);
    for (uint first = 0u; first < groups; first += 256u) {
        uvec2 mine = first + t < groups ? sums[first + t] : uvec2(0u);
        uvec2 sum = scan_group(mine, whole);
        if (first + t < groups)
            sums[first + t] = before + sum;
        before += whole;
    }
    if (t == 0u) {
#ifdef BLOCKS_STEP
        totals[ACTIVE] = before.x;
        uint listed = min(before.x, SLOT_CAPACITY);
        set_dispatch(FOR_ACTIVE, listed);
        set_dispatch(FOR_SCAN, (listed + SCAN - 1u) / SCAN);
        totals[OPEN] = totals[VERTICES] = totals[TRIANGLES] = totals[MISSING] = 0u;
#else
        totals[VERTICES] = before.x;
        totals[TRIANGLES] = before.y;
        bases[count] = before;
#endif
    }
#else
    uint group = group_number(), first = group * SCAN + 4u * t;
    uvec2 mine[4], sum = uvec2(0u);
    for (uint n = 0u; n < 4u; n++) {
        mine[n] = first + n < count ? entry(first + n) : uvec2(0u);
        sum += mine[n];
    }
    uvec2 before = scan_group(sum, whole);
#ifdef SUM_STEP
    if (t == 0u && group * SCAN < count)
        sums[group] = whole;
#else
    if (group * SCAN < count)
        before += sums[group];
    for (uint n = 0u; n < 4u && first + n < count; n++) {
#ifdef BLOCKS_STEP
        bool listed = mine[n].x != 0u && before.x < SLOT_CAPACITY;
        slots[first + n] = listed ? before.x : NO_SLOT;
        if (listed)
            active_blocks[before.x] = first + n;
#else
        bases[first + n] = before;
#endif
        before += mine[n];
    }
#endif
#endif
}
