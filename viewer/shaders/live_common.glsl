// What all passes that extract a surface on the GPU share: what is known of the volume, its voxels,
// blocks and cells. The order of operations is that of extract/dense, and `precise` keeps it.
// TYPE is that of voxels: a number as in the table of live_volume.c.
#define U32 6
#define I32 7
#define F32 8

layout(std430, binding = 0) readonly buffer Params
{
    double numbers[32];
    float caps[32]; // normals of caps: axis, side, component
    int facts[32];
};
#define LEVEL          numbers[0]
#define AFFINE(r, c)   numbers[1 + 3 * (r) + (c)]
#define COFACTOR(r, c) numbers[10 + 3 * (r) + (c)]
#define CENTER(a)      numbers[19 + (a)]
#define SCALE          numbers[22]
#define DIM            ivec3(facts[0], facts[1], facts[2])
#define BLOCKS         ivec3(facts[3], facts[4], facts[5])
#define LIMIT          facts[6]
#define NONE_ABOVE     (facts[7] != 0)
#define INVERT         (facts[8] != 0)
#define ZERO_INSIDE    (facts[9] != 0)
#define HAS_NODATA     (facts[10] != 0)
#define NODATA         facts[11]
#define FLIP           (facts[12] != 0)
#define DIAGONAL       (facts[13] != 0)
#define SLOT_CAPACITY  uint(facts[14])
#define OPEN_CAPACITY  uint(facts[15])
#define MEND_CAPACITY  uint(facts[16])
#define BLOCK_COUNT    uint(facts[17])
#define NODATA_EXISTS (facts[18] != 0)

// Counters, and the sizes of dispatches that follow from them.
layout(std430, binding = 1) buffer Totals
{
    uint totals[32];
};
#define ACTIVE     0 // blocks that the surface crosses
#define OPEN       1 // cells whose signs do not settle the surface
#define VERTICES   2
#define TRIANGLES  3
#define MISSING    4 // vertices whose gradient vanishes
#define GAPS       5 // 1: some voxel has no value
#define LOWEST 6 // of all values, plus 2^31
#define HIGHEST 7
#define FOR_ACTIVE 8 // sizes of a dispatch of one group a block, and of 64 threads a group
#define FOR_SCAN   12
#define FOR_OPEN   16
#define FOR_MEND   20

const uint NO_SLOT = 0xffffffffu, GROUPS_X = 32768u;
const uint SCAN = 1024u; // entries that a group of a scan sums

uint group_number()
{
    return gl_WorkGroupID.x + GROUPS_X * gl_WorkGroupID.y;
}

// ---- voxels ----------------------------------------------------------------------------------

#if TYPE == 1 || TYPE == 3 || TYPE == U32 || TYPE == F32
uniform usampler3D voxels;
#else
uniform isampler3D voxels;
#endif

// A voxel's bits, at an index within the volume.
uint bits_at(ivec3 v)
{
    return uint(texelFetch(voxels, v, 0).r);
}

// A whole number in the order of the voxels' numbers; both zeros of floats are 0.
int key_of(uint bits)
{
#if TYPE == U32
    return int(bits ^ 0x80000000u);
#elif TYPE == F32
    return bits == 0x80000000u ? 0 : int(bits) >= 0 ? int(bits) : int(bits ^ 0x7fffffffu);
#else
    return int(bits);
#endif
}

bool is_finite(uint bits)
{
#if TYPE == F32
    return (bits & 0x7f800000u) != 0x7f800000u;
#else
    return true;
#endif
}

bool has_value(uint bits)
{
#if TYPE == F32
    if ((bits & 0x7fffffffu) > 0x7f800000u)
        return false;
#endif
    return !NODATA_EXISTS || key_of(bits) != NODATA;
}

// A voxel's number. Subnormal floats are made by hand, as machines may take them for 0.
double number_of(uint bits)
{
#if TYPE == F32
    if ((bits & 0x7f800000u) == 0u) {
        precise double small = double(bits & 0x7fffffu) * 1.4012984643248170709e-45LF;
        return (bits & 0x80000000u) != 0u ? -small : small;
    }
    return double(uintBitsToFloat(bits));
#elif TYPE == U32
    return double(bits);
#else
    return double(int(bits));
#endif
}

bool is_within(ivec3 v)
{
    return all(greaterThanEqual(v, ivec3(0))) && all(lessThan(v, DIM));
}

// Returns true for a voxel that exists and has a value.
bool fetch(ivec3 v, out uint bits)
{
    bits = 0u;
    if (!is_within(v))
        return false;
    bits = bits_at(v);
    return has_value(bits);
}

bool is_inside(uint bits)
{
    return (!NONE_ABOVE && key_of(bits) >= LIMIT) != INVERT;
}

// ---- blocks ----------------------------------------------------------------------------------

// A block's first padded sample: sample n is voxel n - 1.
ivec3 first_sample(uint block)
{
    ivec3 n = BLOCKS;
    int b = int(block);
    return 8 * ivec3(b % n.x, b / n.x % n.y, b / (n.x * n.y));
}

// A block that the surface crosses keeps: for each axis, which of the edges from its 512 samples are
// crossed; how many are in the words before, two a word; the inside bits of 81 rows of 9 samples,
// three rows a word; the number of edges.
const uint RECORD = 100u, RANKS = 48u, ROWS = 72u, EDGES = 99u;
