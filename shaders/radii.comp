#version 430
// The k nearest neighbours of points among the points of one piece of a chunk, added to those found in other pieces. A
// workgroup looks at one block of at most 64 points, an invocation at one of them. Permutations:
//   WIDE: positions are 64-bit;
//   NORMALS: a neighbour's value is its squared distance from the line along the point's normal; without, its squared distance;
//   FINISH: the radius, the root of the largest value of the neighbours found.
//
// Positions are grid steps relative to an origin, modulo 2^32 (2^64), and of all differences the true one is representable, so they
// are exact. Lengths are in a unit that is a power of two of the source's. Without NORMALS squared distances are floats: the k-th
// smallest has their relative error. NORMALS needs the right neighbours, so candidates are compared in double, with the bits that
// the processor gets.
//
// Neighbours of a point are a heap with the farthest on top. Entry i of point q lies at i * stride + q.
layout(local_size_x = 64) in;

#ifdef NORMALS
#define KEY double
layout(std430, binding = 2) buffer Values { float values[]; };
layout(std430, binding = 3) readonly buffer Normals { double normals[]; };
uniform dvec3 exact_scale;
#else
#define KEY float
#endif
layout(std430, binding = 1) buffer Keys { KEY keys[]; };
uniform uint neighbours, stride;

#ifdef FINISH
layout(std430, binding = 0) writeonly buffer Radii { float radii[]; };
uniform float unit;
uniform uint points;

void main()
{
    uint q = gl_GlobalInvocationID.x;
    if (q >= points) return;
    float largest = 0.0;
    for (uint i = 0u; i < neighbours; ++i) {
        float key = float(keys[i * stride + q]);
        if (key > 3e38) continue;  // infinite: there are fewer neighbours than asked for
#ifdef NORMALS
        largest = max(largest, values[i * stride + q]);
#else
        largest = max(largest, key);
#endif
    }
    radii[q] = sqrt(largest) * unit;
}
#else

#ifdef WIDE
#define STEPS uvec2
#else
#define STEPS uint
#endif

// Points, or in the first boxes, the groups, blocks: [first, end).
struct Box {
    STEPS low[3], high[3];
    uint first, end;
};
layout(std430, binding = 0) readonly buffer Queries { STEPS queries[]; };
layout(std430, binding = 4) readonly buffer Positions { STEPS positions[]; };
layout(std430, binding = 5) readonly buffer Boxes { Box boxes[]; };
// Each block has its first point, its number of points, the box to begin with, and the number of its first point in this piece: beyond its
// points when they are not in this chunk; negative, modulo 2^32, when the block begins in the piece before.
layout(std430, binding = 6) readonly buffer Blocks { uvec4 blocks[]; };
uniform uint first_block, groups, group_size;
uniform STEPS shift[3];  // from the queries' origin to the piece's
uniform vec3 scale;

#ifdef WIDE
STEPS moved(STEPS a, STEPS by)
{
    uint carry;
    uint low = uaddCarry(a.x, by.x, carry);
    return uvec2(low, a.y + by.y + carry);
}

STEPS difference(STEPS a, STEPS b)
{
    uint borrow;
    uint low = usubBorrow(a.x, b.x, borrow);
    return uvec2(low, a.y - b.y - borrow);
}

float steps(STEPS a, STEPS b)
{
    STEPS d = difference(a, b);
    bool negative = int(d.y) < 0;
    if (negative) d = difference(uvec2(0u), d);
    float size = float(d.y) * 4294967296.0 + float(d.x);
    return negative ? -size : size;
}

#ifdef NORMALS
double exact_steps(STEPS a, STEPS b)
{
    STEPS d = difference(a, b);
    return double(int(d.y)) * 4294967296.0lf + double(d.x);
}
#endif
#else
STEPS moved(STEPS a, STEPS by) { return a + by; }
float steps(STEPS a, STEPS b) { return float(int(a - b)); }
#ifdef NORMALS
double exact_steps(STEPS a, STEPS b) { return double(int(a - b)); }
#endif
#endif

// The index of this invocation's point.
uint query;
uint self;  // its number in the piece
STEPS at[3];
float limit;  // squared distances from here on are not among the nearest; a little large

// From this invocation's point. Vectors are made whole: NVIDIA's compiler cannot link a program that assigns to a component of a dvec3 by
// an index that is not constant.
vec3 offset(uint point)
{
    uint p = 3u * point;
    return vec3(steps(positions[p], at[0]), steps(positions[p + 1u], at[1]), steps(positions[p + 2u], at[2])) * scale;
}

#ifdef NORMALS
dvec3 exact_offset(uint point)
{
    uint p = 3u * point;
    return dvec3(exact_steps(positions[p], at[0]), exact_steps(positions[p + 1u], at[1]), exact_steps(positions[p + 2u], at[2])) * exact_scale;
}
#endif

void take(KEY key, float value)
{
    uint i = 0u;
    for (uint child = 1u; child < neighbours; child = 2u * i + 1u) {
        KEY largest = keys[child * stride + query];
        if (child + 1u < neighbours) {
            KEY other = keys[(child + 1u) * stride + query];
            if (other > largest) {
                largest = other;
                ++child;
            }
        }
        if (largest <= key) break;
        keys[i * stride + query] = largest;
#ifdef NORMALS
        values[i * stride + query] = values[child * stride + query];
#endif
        i = child;
    }
    keys[i * stride + query] = key;
#ifdef NORMALS
    values[i * stride + query] = value;
#endif
}

void set_limit()
{
    // Rounded differently, equal distances differ by less than 1e-6.
#ifdef NORMALS
    limit = float(keys[query]) * 1.000002;
#else
    limit = keys[query];
#endif
}

void compare(uint point, float square)
{
#ifdef NORMALS
    dvec3 d = exact_offset(point);
    precise double key = d.x * d.x + d.y * d.y;
    key += d.z * d.z;
    if (key >= keys[query]) return;
    dvec3 normal = dvec3(normals[3u * query], normals[3u * query + 1u], normals[3u * query + 2u]);
    d -= normal * dot(normal, d);
    take(key, float(dot(d, d)));
#else
    take(square, 0.0);
#endif
    set_limit();
}

bool is_near(uint box)
{
    vec3 below = vec3(steps(boxes[box].low[0], at[0]), steps(boxes[box].low[1], at[1]), steps(boxes[box].low[2], at[2]));
    vec3 above = vec3(steps(at[0], boxes[box].high[0]), steps(at[1], boxes[box].high[1]), steps(at[2], boxes[box].high[2]));
    vec3 d = max(max(below, above), vec3(0.0)) * scale;
    return dot(d, d) * 0.999998 < limit;
}

void search(uint box)
{
    uint end = boxes[box].end;
    for (uint point = boxes[box].first; point < end; ++point) {
        vec3 d = offset(point);
        float square = dot(d, d);
        if (square < limit && point != self) compare(point, square);
    }
}

void main()
{
    uvec4 block = blocks[first_block + gl_WorkGroupID.x];
    if (gl_LocalInvocationID.x >= block.y) return;
    query = block.x + gl_LocalInvocationID.x;
    self = block.w + gl_LocalInvocationID.x;
    for (uint a = 0u; a < 3u; ++a) at[a] = moved(queries[3u * query + a], shift[a]);
    set_limit();
    // The nearest boxes first: the more is left out afterwards.
    uint start = block.z;
    uint group = min((start - groups) / group_size, groups - 1u);
    for (uint g = 0u; g < groups; ++g) {
        if (is_near(group)) {
            uint first = boxes[group].first, end = boxes[group].end;
            uint box = start >= first && start < end ? start : first;
            for (uint b = first; b < end; ++b) {
                if (is_near(box)) search(box);
                if (++box == end) box = first;
            }
        }
        if (++group == groups) group = 0u;
    }
}
#endif
