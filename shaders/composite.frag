#version 330 core
// Composites a picture of splats, colour and depth, into another framebuffer. Permutations: SAMPLES n (of the picture; absent: one per
// pixel), REVERSED (its depth runs from 1 at the near plane to 0), RESOLVE (into an offscreen target, depth unchanged), EYE_DOME n (of the eight neighbours
// every n-th is looked at).
//
// With several samples, the colours of the covered ones are averaged, their fraction becomes the alpha, and the nearest depth is written.
//
// Eye-dome lighting (Boucheny 2009): the farther a pixel lies behind its neighbours, the darker it is, so that edges and relief show
// without normals. In perspective, relief is a ratio of distances, so that it does not depend on the unit of length.

#ifdef SAMPLES
uniform sampler2DMS colours;
uniform sampler2DMS depths;
#else
uniform sampler2D colours;
uniform sampler2D depths;
#endif
uniform ivec2 corner;      // of the viewport, in the target's pixels
uniform vec2 depth_range;  // of the target

layout(location = 0) out vec4 fragment;

#ifdef REVERSED
float nearer(float a, float b) { return max(a, b); }
const float farthest = 0.0;
#else
float nearer(float a, float b) { return min(a, b); }
const float farthest = 1.0;
#endif

#ifdef EYE_DOME
uniform vec4 distance_of_depth;     // distance = (x + y * d) / (z + w * d), where d is 1 at the near plane
uniform float relief_of_distance;   // orthographic: 1 / visible height; 0: perspective
uniform float strength;
uniform ivec2 size;

float eye_distance(float depth)
{
#ifdef REVERSED
    float d = depth;
#else
    float d = 1.0 - depth;
#endif
    return (distance_of_depth.x + distance_of_depth.y * d) / (distance_of_depth.z + distance_of_depth.w * d);
}

float shade(ivec2 at, float depth)
{
    const ivec2 ring[8] = ivec2[8](ivec2(2, 0), ivec2(1, 1), ivec2(0, 2), ivec2(-1, 1), ivec2(-2, 0), ivec2(-1, -1), ivec2(0, -2), ivec2(1, -1));
    float here = eye_distance(depth);
    float relief = 0.0, ratios = 1.0;  // the sum of the logarithms of ratios is the logarithm of their product
    float covered = 0.0;
    for (int i = 0; i < 8; i += EYE_DOME) {
        ivec2 beside = at + ring[i];
        if (any(lessThan(beside, ivec2(0))) || any(greaterThanEqual(beside, size))) continue;
        float depth_there = texelFetch(depths, beside, 0).r;
        if (depth_there == farthest) continue;  // the background is behind everything
        covered += float(EYE_DOME) / 8.0;
        float there = eye_distance(depth_there);
        if (relief_of_distance > 0.0)
            relief += max(0.0, (here - there) * relief_of_distance);
        else
            ratios *= max(1.0, here / there);
    }
    relief += log2(min(ratios, 1e30));
    // Points that stand alone are no surface: between them relief is noise.
    return exp(-12.5 * float(EYE_DOME) * strength * relief * smoothstep(0.2, 0.6, covered));
}
#endif

void main()
{
    ivec2 at = ivec2(gl_FragCoord.xy) - corner;
    float depth = farthest;
#ifdef SAMPLES
    vec3 sum = vec3(0.0);
    int covered = 0;
    for (int i = 0; i < SAMPLES; ++i) {
        vec4 colour = texelFetch(colours, at, i);
        if (colour.a == 0.0) continue;
        sum += colour.rgb;
        ++covered;
        depth = nearer(depth, texelFetch(depths, at, i).r);
    }
    if (covered == 0) discard;
    fragment = vec4(sum / float(covered), float(covered) / float(SAMPLES));
#else
    fragment = texelFetch(colours, at, 0);
    if (fragment.a == 0.0) discard;
    depth = texelFetch(depths, at, 0).r;
#endif
#ifdef EYE_DOME
    fragment.rgb *= shade(at, depth);
#endif
#ifdef RESOLVE
    gl_FragDepth = depth;
#else
#ifdef REVERSED
    depth = 1.0 - depth;
#endif
    gl_FragDepth = mix(depth_range.x, depth_range.y, depth);
#endif
}
