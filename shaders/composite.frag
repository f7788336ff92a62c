#version 330 core
// Composites a picture of splats, colour and depth, into another framebuffer. Permutations: SAMPLES n (of the picture; absent: one per
// pixel), REVERSED (its depth runs from 1 at the near plane to 0), RESOLVE (into an offscreen target, depth unchanged), RESOLVED (it is one of
// these), SUM (colours times coverage, and coverage, to be added up; without depth), EYE_DOME n (of the pairs of opposite neighbours every n-th is looked at), CLOSE_GAPS,
// SHADES (how bright eye-dome lighting leaves every other pixel of every other row, and nothing else), SHADED (these are given).
//
// With several samples, the colours of the covered ones are averaged, their fraction becomes the alpha, and the nearest depth is written.
//
// Eye-dome lighting (after Boucheny 2009): the farther a pixel lies behind its neighbours, the darker it is, so that edges and relief show
// without normals. In perspective, relief is a ratio of distances, so that it does not depend on the unit of length. Three things are not
// relief, and do not change a pixel:
//   the slope of a surface: a pixel is compared with the middle between opposite neighbours. In perspective 1 / distance is linear on the
//     screen along a plane, so h / a + h / b - 2 is 0 for all planes, seen face-on or at any grazing angle, and (h - b) / b for a step next to
//     a surface at distance h = a;
//   the steps of a depth camera (view/depth_steps.h), up to two and a half of which are as flat as what it saw;
//   the shape of splats: steps below the splats' own radii are of how the surface was sampled (splat.frag marks each pixel with its splat's
//     width), and so are those that a splat's width makes of a slope.

#ifdef SAMPLES
uniform sampler2DMS colours;
uniform sampler2DMS depths;
#else
uniform sampler2D colours;
uniform sampler2D depths;
#endif
uniform ivec2 corner;      // corner of the viewport, in the target's pixels
uniform vec2 depth_range;  // depth range of the target

layout(location = 0) out vec4 fragment;

#ifdef REVERSED
float nearer(float a, float b) { return max(a, b); }
const float farthest = 0.0;
#else
float nearer(float a, float b) { return min(a, b); }
const float farthest = 1.0;
#endif

// Alpha, as splat.vert makes it: in the low four bits how wide a pixel's splat is; in the high ones how deep the steps are in which its surface
// was measured, or (RESOLVED) how much of the pixel is covered, in 15 steps. 0: nothing was drawn.
float mark_of(float alpha) { return mod(floor(alpha * 255.0 + 0.5), 16.0); }
float side_of(float alpha) { return exp2(0.5 * (15.0 - mark_of(alpha))); }
float high_bits_of(float alpha) { return floor(alpha * 255.0 / 16.0 + 0.01); }
#if defined(RESOLVED)
float coverage_of(float alpha) { return high_bits_of(alpha) / 15.0; }
float step_of(float alpha) { return 0.0; }
#else
float coverage_of(float alpha) { return 1.0; }
float step_of(float alpha) { return high_bits_of(alpha) < 15.0 ? exp2(0.5 * (14.0 - high_bits_of(alpha))) : 0.0; }
#endif

const float steps_hidden = 2.5;

#if defined(EYE_DOME) || defined(CLOSE_GAPS) || defined(SHADED)
uniform ivec2 size;
#endif
#if defined(EYE_DOME) || defined(CLOSE_GAPS)
uniform vec4 distance_of_depth;     // distance = (x + y * d) / (z + w * d), where d is 1 at the near plane
uniform float relief_of_distance;   // orthographic: 1 / visible height; 0: perspective
uniform float relief_of_pixel;      // relief of a step as deep as a pixel is wide

float eye_distance(float depth)
{
#ifdef REVERSED
    float d = depth;
#else
    float d = 1.0 - depth;
#endif
    return (distance_of_depth.x + distance_of_depth.y * d) / (distance_of_depth.z + distance_of_depth.w * d);
}
#endif

#ifdef CLOSE_GAPS
const int widest_gap = 6;  // pixels to either side

// The first covered pixel from `at` in a direction, and how many steps away it is; 0: there is none.
int end_of(ivec2 at, ivec2 step, out vec4 colour, out float depth)
{
    for (int k = 1; k <= widest_gap; ++k) {
        at += step;
        if (any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, size))) return 0;
        colour = texelFetch(colours, at, 0);
        if (colour.a == 0.0) continue;
        depth = texelFetch(depths, at, 0).r;
        return k;
    }
    return 0;
}

// A pixel that no splat covers lies in a surface if splats end on both sides of it, along at least three of the four lines through it, no
// farther apart than their points may be, and all of these lines pass it at the same depth. (Depth is linear on the screen along a plane.)
bool is_in_surface(ivec2 at, out vec4 colour, out float depth)
{
    const ivec2 steps[4] = ivec2[4](ivec2(1, 0), ivec2(0, 1), ivec2(1, 1), ivec2(1, -1));
    // Most empty pixels belong to the background, far from everything.
    ivec2 last = size - 1;
    if (texelFetch(depths, min(at + ivec2(widest_gap, 0), last), 0).r == farthest && texelFetch(depths, max(at - ivec2(widest_gap, 0), ivec2(0)), 0).r == farthest &&
        texelFetch(depths, min(at + ivec2(0, widest_gap), last), 0).r == farthest && texelFetch(depths, max(at - ivec2(0, widest_gap), ivec2(0)), 0).r == farthest)
        return false;
    float lines = 0.0, weights = 0.0, low = 2.0, high = -1.0;
    float side = 0.0, alpha = 1.0;
    vec3 sum = vec3(0.0);
    depth = 0.0;
    for (int i = 0; i < 4; ++i) {
        if (float(i) - lines > 1.5) return false;
        vec4 colour_a, colour_b;
        float depth_a, depth_b;
        int a = end_of(at, steps[i], colour_a, depth_a);
        if (a == 0) continue;
        int b = end_of(at, -steps[i], colour_b, depth_b);
        if (b == 0) continue;
        float between = float(a + b - 1) * (i < 2 ? 1.0 : 1.414);
        float side_a = side_of(colour_a.a), side_b = side_of(colour_b.a);
        if (between > max(3.0, 0.6 * max(side_a, side_b))) continue;
        float passed = (depth_a * float(b) + depth_b * float(a)) / float(a + b);
        low = min(low, passed);
        high = max(high, passed);
        side += min(side_a, side_b);
        lines += 1.0;
        vec2 weight = 1.0 / vec2(a, b);
        sum += colour_a.rgb * weight.x + colour_b.rgb * weight.y;
        weights += weight.x + weight.y;
        depth += passed;
        alpha = min(alpha, min(colour_a.a, colour_b.a));  // the deepest steps', else the widest splat's
    }
    if (lines < 3.0) return false;
    colour = vec4(sum / weights, alpha);
    depth /= lines;
    vec2 ends = vec2(eye_distance(low), eye_distance(high));
    float apart = abs(ends.x - ends.y) * (relief_of_distance > 0.0 ? relief_of_distance : 1.0 / min(ends.x, ends.y));
    return apart <= min(side / lines, 6.0) * relief_of_pixel;
}
#endif

#ifdef EYE_DOME
uniform float strength;

// How far a pixel lies behind the middle between two opposite neighbours, and by how much one of these is farther than the other: x and y.
// False where there is no such pair. The background is behind everything.
bool compare(ivec2 at, ivec2 away, float here, out vec2 relief)
{
    ivec2 a = at + away, b = at - away;
    relief = vec2(0.0);
    if (any(lessThan(min(a, b), ivec2(0))) || any(greaterThanEqual(max(a, b), size))) return false;
    vec2 there = vec2(texelFetch(depths, a, 0).r, texelFetch(depths, b, 0).r);
    if (there.x == farthest || there.y == farthest) return false;
    there = vec2(eye_distance(there.x), eye_distance(there.y));
    vec2 steps = relief_of_distance > 0.0 ? (here - there) * relief_of_distance : here / there - 1.0;
    relief = vec2(steps.x + steps.y, abs(steps.x - steps.y));
    return true;
}

// How wide the splats of a pixel's neighbours are, and how deep their steps.
vec2 widest_beside(ivec2 at, ivec2 away)
{
    float a = texelFetch(colours, at + away, 0).a, b = texelFetch(colours, at - away, 0).a;
    return vec2(exp2(0.5 * (15.0 - min(mark_of(a), mark_of(b)))), step_of(min(a, b)));
}

float shade(ivec2 at, float depth, float side, float step)
{
    const ivec2 half_ring[4] = ivec2[4](ivec2(2, 0), ivec2(0, 2), ivec2(1, 1), ivec2(-1, 1));
    float here = eye_distance(depth);
    float wide = max(6.0, side);  // radius of the second ring; in pixels, so that tiles of a picture show what it would
    vec2 edges[4], bends[4];
    vec2 slope = vec2(0.0);  // slope of the surface, on each ring
    float pairs = 0.0;
    for (int i = 0; i < 4; i += EYE_DOME) {
        if (compare(at, half_ring[i], here, edges[i])) pairs += 0.25 * float(EYE_DOME);
        compare(at, ivec2(0.5 * wide * vec2(half_ring[i])), here, bends[i]);
        slope = max(slope, vec2(edges[i].y, bends[i].y));
    }
    vec2 own = (vec2(0.75, 0.35) * side + steps_hidden * step) * relief_of_pixel + vec2(0.3, 0.4 * side / wide) * slope;
    float ratios = 1.0, bent = 0.0;  // the sum of the logarithms of ratios is the logarithm of their product
    for (int i = 0; i < 4; i += EYE_DOME) {
        if (edges[i].x > own.x) {
            // Points that stand alone, as leaves do, have no rims around them either.
            vec2 beside = widest_beside(at, half_ring[i]);
            float fade = min(1.0, 12.0 / beside.x);
            float hidden = own.x + max(0.0, beside.y - step) * steps_hidden * relief_of_pixel;
            ratios *= 1.0 + max(0.0, edges[i].x - hidden) * fade * fade;
        }
        // In widths of the ring. A step, which is far more, is not a bend.
        float bend = max(0.0, max(bends[i].x, -0.3 * bends[i].x) - own.y) / (wide * relief_of_pixel);
        bent += bend / (1.0 + bend * bend / 9.0);
    }
    // Edges of large splats are seen anyway. Points that stand alone are not a surface: between them relief is noise.
    float dark = 12.5 * log2(min(ratios, 1e30)) * min(1.0, 12.0 / side) + 0.09 * bent;
    return exp(-float(EYE_DOME) * strength * dark * smoothstep(0.2, 0.6, pairs));
}
#endif

#ifdef SHADED
uniform sampler2D shades;
#endif

#ifdef SHADES
void main()
{
    ivec2 at = 2 * ivec2(gl_FragCoord.xy);
    float alpha = texelFetch(colours, at, 0).a;
    fragment = vec4(alpha == 0.0 ? 1.0 : shade(at, texelFetch(depths, at, 0).r, side_of(alpha), step_of(alpha)));
}
#else
void main()
{
    ivec2 at = ivec2(gl_FragCoord.xy) - corner;
    float depth = farthest;
#ifdef SAMPLES
    vec3 sum = vec3(0.0);
    int covered = 0;
    float mark = 15.0;
    for (int i = 0; i < SAMPLES; ++i) {
        vec4 colour = texelFetch(colours, at, i);
        if (colour.a == 0.0) continue;
        sum += colour.rgb;
        mark = min(mark, mark_of(colour.a));
#ifdef RESOLVE
        // Its high bits will be the coverage: a splat as wide as hides the steps.
        mark = clamp(14.5 - 2.0 * log2(max(4.0 / 3.0 * steps_hidden * step_of(colour.a), 0.1)), 0.0, mark);
#endif
        ++covered;
        depth = nearer(depth, texelFetch(depths, at, i).r);
    }
    if (covered == 0) discard;
    fragment = vec4(sum / float(covered), float(covered) / float(SAMPLES));
#ifdef RESOLVE
    fragment.a = (max(1.0, floor(15.0 * fragment.a + 0.5)) * 16.0 + floor(mark)) / 255.0;
#endif
#else
    fragment = texelFetch(colours, at, 0);
    depth = texelFetch(depths, at, 0).r;
#ifdef CLOSE_GAPS
    if (fragment.a == 0.0 && !is_in_surface(at, fragment, depth)) discard;
#else
    if (fragment.a == 0.0) discard;
#endif
#ifdef EYE_DOME
    fragment.rgb *= shade(at, depth, side_of(fragment.a), step_of(fragment.a));
#endif
#ifdef SHADED
    // Its pixels are those of even columns and rows.
    fragment.rgb *= texture(shades, (vec2(at) + 1.0) * 0.5 / vec2((size + 1) / 2)).r;
#endif
    fragment.a = coverage_of(fragment.a);
#endif
#if defined(SUM)
    fragment.rgb *= fragment.a;
#elif defined(RESOLVE)
    gl_FragDepth = depth;
#else
#ifdef REVERSED
    depth = 1.0 - depth;
#endif
    gl_FragDepth = mix(depth_range.x, depth_range.y, depth);
#endif
}
#endif
