// Finds how many groups of 64 threads the next pass needs: for open cells, or for missing normals.
layout(local_size_x = 1) in;

void main()
{
#ifdef MEND_STEP
    uint count = min(totals[MISSING], MEND_CAPACITY), at = FOR_MEND;
#else
    uint count = min(totals[OPEN], OPEN_CAPACITY), at = FOR_OPEN;
#endif
    uint groups = (count + 63u) / 64u;
    totals[at] = min(groups, GROUPS_X);
    totals[at + 1u] = (groups + GROUPS_X - 1u) / GROUPS_X;
    totals[at + 2u] = 1u;
}
