// Classifies the samples of the blocks that the surface may cross, and counts the vertices on their
// edges and the triangles of cells whose signs settle them. Lists the other cells.
layout(local_size_x = 64) in;
layout(std430, binding = 4) readonly buffer Active
{
    uint active_blocks[];
};
layout(std430, binding = 5) writeonly buffer Records
{
    uint records[];
};
layout(std430, binding = 6) writeonly buffer Counts
{
    uvec2 counts[];
};
layout(std430, binding = 9) writeonly buffer OpenCells
{
    uvec4 open_cells[];
};
layout(std430, binding = 10) writeonly buffer OpenFirst
{
    uint open_first[]; // of each block
};
layout(std430, binding = 13) readonly buffer Tables
{
    uint tables[];
};
shared uint rows[81], crossed[3][64], words[48], ranks[48], open_here[64];
shared uint triangles, open_count, open_base;

void main()
{
    uint slot = group_number(), t = gl_LocalInvocationIndex;
    if (slot >= min(totals[ACTIVE], SLOT_CAPACITY))
        return;
    for (uint n = t; n < 81u; n += 64u)
        rows[n] = 0u;
    if (t == 0u)
        triangles = open_count = 0u;
    barrier();
    ivec3 first = first_sample(active_blocks[slot]) - 1;
    for (int n = int(t); n < 729; n += 64) {
        uint bits;
        if (fetch(first + ivec3(n % 9, n / 9 % 9, n / 81), bits) && is_inside(bits))
            atomicOr(rows[n / 9], 1u << (n % 9));
    }
    barrier();
    uint r = t / 8u * 9u + t % 8u; // a row of cells: y and z are three bits each
    uint r00 = rows[r], r10 = rows[r + 1u], r01 = rows[r + 9u], r11 = rows[r + 10u];
    crossed[0][t] = (r00 ^ r00 >> 1) & 255u;
    crossed[1][t] = (r00 ^ r10) & 255u;
    crossed[2][t] = (r00 ^ r01) & 255u;
    uint some = r00 | r10 | r01 | r11, every = r00 & r10 & r01 & r11;
    uint mixed = (some | some >> 1) & ~(every & every >> 1) & 255u;
    uint count = 0u, open = 0u;
    for (uint left = mixed; left != 0u; left &= left - 1u) {
        uint i = uint(findLSB(left));
        uint cube = (r00 >> i & 3u) | (r10 >> i & 3u) << 2 | (r01 >> i & 3u) << 4 |
                    (r11 >> i & 3u) << 6;
        uint of = tables[cube];
        if ((of >> 10 & 1u) != 0u)
            open |= 1u << i;
        else
            count += of >> 17 & 7u;
    }
    atomicAdd(triangles, count);
    open_here[t] = uint(bitCount(open));
    atomicAdd(open_count, open_here[t]);
    barrier();
    if (t < 48u) {
        uint axis = t / 16u, n = 4u * (t % 16u);
        words[t] = crossed[axis][n] | crossed[axis][n + 1u] << 8 | crossed[axis][n + 2u] << 16 |
                   crossed[axis][n + 3u] << 24;
    }
    barrier();
    if (t < 48u) {
        uint sum = 0u;
        for (uint n = 0u; n < t; n++)
            sum += uint(bitCount(words[n]));
        ranks[t] = sum;
    }
    if (t == 48u && open_count > 0u)
        open_base = atomicAdd(totals[OPEN], open_count);
    barrier();
    uint at = slot * RECORD;
    if (t < 48u)
        records[at + t] = words[t];
    if (t < 24u)
        records[at + RANKS + t] = ranks[2u * t] | ranks[2u * t + 1u] << 16;
    if (t < 27u)
        records[at + ROWS + t] =
            rows[3u * t] | rows[3u * t + 1u] << 9 | rows[3u * t + 2u] << 18;
    if (t == 0u) {
        uint edges = ranks[47] + uint(bitCount(words[47]));
        records[at + EDGES] = edges;
        counts[slot] = uvec2(edges, triangles);
        open_first[slot] = open_count > 0u ? open_base : 0u;
    }
    if (open != 0u) {
        uint to = open_base;
        for (uint n = 0u; n < t; n++)
            to += open_here[n];
        for (; open != 0u; open &= open - 1u, to++)
            if (to < OPEN_CAPACITY)
                open_cells[to] = uvec4(slot << 9 | t << 3 | uint(findLSB(open)), 0u, 0u, 0u);
    }
}
