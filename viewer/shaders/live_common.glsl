// Parameters, voxels, blocks and arithmetic that all passes share which extract a surface on the
// GPU. The order of operations is that of extract/dense, and `precise` keeps it.
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
#define NODATA_EXISTS  (facts[18] != 0)
#define ZERO           facts[19] // for bounds of loops that compilers are not to unroll

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
#define LOWEST     6 // of all values, plus 2^31
#define HIGHEST    7
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

// ---- doubles ---------------------------------------------------------------------------------
// NVIDIA's compiler keeps elements of arrays of doubles, whose index is no constant, as floats. So
// arrays are of their bits, and vectors are read and written by component.
double get(dvec3 v, int axis)
{
    return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

void set(inout dvec3 v, int axis, double x)
{
    if (axis == 0)
        v.x = x;
    else if (axis == 1)
        v.y = x;
    else
        v.z = x;
}

uvec2 pack(double x)
{
    return unpackDouble2x32(x);
}

double unpack(uvec2 bits)
{
    return packDouble2x32(bits);
}

// ---- arithmetic ------------------------------------------------------------------------------

// The error of a product in double precision, exactly [Dekker1971].
double product_error(double a, double b, double product)
{
    precise double big = 134217729.0LF * a;
    precise double a_high = big - (big - a);
    precise double a_low = a - a_high;
    big = 134217729.0LF * b;
    precise double b_high = big - (big - b);
    precise double b_low = b - b_high;
    precise double error = a_high * b_high - product;
    error = error + a_high * b_low;
    error = error + a_low * b_high;
    error = error + a_low * b_low;
    return error;
}

// A quotient as a processor rounds it: that of some GPUs has half of a double's digits.
double quotient(double a, double b)
{
    precise double q = a / b;
    if (isnan(q) || isinf(q) || isinf(b) || q == 0.0LF)
        return q;
    for (int n = 0; n < 2; n++) {
        precise double product = q * b;
        precise double rest = a - product;
        rest = rest - product_error(q, b, product);
        precise double more = rest / b;
        q = q + more;
    }
    return q;
}

// A square root as a processor rounds it.
double root_of(double x)
{
    precise double s = sqrt(x);
    if (!(s > 0.0LF) || isinf(s))
        return s;
    for (int n = 0; n < 2; n++) {
        precise double product = s * s;
        precise double rest = x - product;
        rest = rest - product_error(s, s, product);
        precise double more = rest / (s + s);
        s = s + more;
    }
    return s;
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
        precise double small =
            double(bits & 0x7fffffu) * unpack(uvec2(0u, 0x36a00000u)); // 2^-149
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
