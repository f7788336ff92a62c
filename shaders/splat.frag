#version 330 core
flat in vec3 splat_colour;
layout(location = 0) out vec4 fragment;

void main() { fragment = vec4(splat_colour, 1.0); }
