/* SPDX-License-Identifier: MIT
 *
 * The scene and the camera of both Direct3D samples: a ball on a chequered floor, with lights in front of it and behind
 * it, made of triangles. Lengths are in metres; +y is up, and the camera looks along +z.
 */
#ifndef SCENE_H
#define SCENE_H

#include <math.h>

#define WIDTH 320
#define HEIGHT 240

/* numbers of rings and segments of a ball */
#define RINGS 12
#define SEGMENTS 24

enum { MAX_BALLS = 18, MAX_VERTICES = MAX_BALLS * RINGS * SEGMENTS * 6 + 12 };

static const float PI = 3.14159265f;
/* FIELD_OF_VIEW is the vertical field of view of an 85 mm lens, radians */
static const float FIELD_OF_VIEW = 0.2805f, F_STOP = 1.0f, SENSOR_HEIGHT = 0.024f, MAX_COC = 0.1f;
static const float PULL_SECONDS = 0.2f; /* time constant of the autofocus */
static const float Z_NEAR = 0.5f, Z_FAR = 50.0f;
static const float SUBJECT[3] = {-0.06f, 0.19f, 3.0f}; /* centre of the ball that is in focus */

typedef struct {
    float place[3];
    float radiance[3]; /* linear colour of the surface; lights are much brighter than 1 */
    float pattern;     /* 1 if the surface is chequered, else 0 */
} Vertex;

/* The corners of two triangles that make a quad. */
static const int QUAD[6][2] = {{0, 0}, {0, 1}, {1, 0}, {1, 0}, {0, 1}, {1, 1}};

static Vertex vertices[MAX_VERTICES];
static int num_vertices;

/* The shader constants of the scene, in five registers. */
typedef struct {
    float eye[4], right[4], up[4], forward[4];
    float lens[4]; /* xy: scale from view space to clip space; zw: the depth buffer gets z + w / depth */
} Camera;

static float dot3(const float a[3], const float b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Returns the focal length that belongs to the field of view, metres (docs/lens.md). */
static float focal_length(void)
{
    return SENSOR_HEIGHT / (2.0f * tanf(0.5f * FIELD_OF_VIEW));
}

/* Returns a camera at (0, 0.55, 0) that looks down a little. */
static Camera make_camera(void)
{
    const float c = cosf(0.1f), s = sinf(0.1f), y = 1.0f / tanf(0.5f * FIELD_OF_VIEW);
    Camera camera = {
        {0, 0.55f, 0, 0}, {1, 0, 0, 0}, {0, c, s, 0}, {0, -s, c, 0},
        {y * HEIGHT / WIDTH, y, Z_FAR / (Z_FAR - Z_NEAR), -Z_NEAR * Z_FAR / (Z_FAR - Z_NEAR)},
    };
    return camera;
}

/* Offsets, in pixels, from a clicked pixel. The autofocus moves to the nearest of the depths there. */
enum { NUM_AIMS = 5 };
static const int AIMS[NUM_AIMS][2] = {{0, 0}, {-6, 0}, {6, 0}, {0, -6}, {0, 6}};

/* Returns the new focus distance of the autofocus (docs/lens.md), which moves smoothly towards the nearest of several
 * depths.
 *
 * distance  current focus distance, metres
 * depths    metres along the view axis
 * seconds   time since the last call
 * tau       time constant, seconds */
static float pulled_focus(float distance, const float depths[NUM_AIMS], float seconds, float tau)
{
    const float k = 1.0f - expf(-seconds / tau);
    float nearest = 0.0f;
    for (int i = 0; i < NUM_AIMS; i++)
        nearest = fmaxf(nearest, 1.0f / depths[i]);
    return 1.0f / ((1.0f - k) / distance + k * nearest);
}

/* Returns the depth of a point along the view axis, metres. To focus on the point, set BokehFocusDistance to it. */
static float view_depth(const Camera *camera, const float place[3])
{
    const float way[3] = {place[0] - camera->eye[0], place[1] - camera->eye[1], place[2] - camera->eye[2]};
    return dot3(way, camera->forward);
}

static void add_vertex(float x, float y, float z, const float radiance[3], float brightness, float pattern)
{
    const Vertex vertex = {
        {x, y, z}, {radiance[0] * brightness, radiance[1] * brightness, radiance[2] * brightness}, pattern,
    };
    vertices[num_vertices++] = vertex;
}

/* Adds a point of a ball: `ring` goes from pole to pole, `segment` goes around the axis. */
static void add_ball_vertex(const float middle[3], float radius, const float radiance[3], int lit, int ring,
                            int segment)
{
    const float down = PI * ring / RINGS, around = 2.0f * PI * segment / SEGMENTS;
    const float normal[3] = {sinf(down) * cosf(around), cosf(down), sinf(down) * sinf(around)};
    const float sun[3] = {-0.5f, 0.7f, -0.5f};
    const float brightness = lit ? 0.25f + 0.75f * fmaxf(dot3(normal, sun), 0.0f) : 1.0f;
    add_vertex(middle[0] + radius * normal[0], middle[1] + radius * normal[1], middle[2] + radius * normal[2], radiance,
               brightness, (float)lit);
}

/* Adds a ball: a lit, chequered one if `lit` is 1, or a light if it is 0. */
static void add_ball(const float middle[3], float radius, const float radiance[3], int lit)
{
    for (int ring = 0; ring < RINGS; ring++)
        for (int segment = 0; segment < SEGMENTS; segment++)
            for (int i = 0; i < 6; i++)
                add_ball_vertex(middle, radius, radiance, lit, ring + QUAD[i][0], segment + QUAD[i][1]);
}

static void make_scene(void)
{
    static const float FLOOR[3] = {0.22f, 0.2f, 0.18f}, WALL[3] = {0.05f, 0.07f, 0.12f}, RED[3] = {0.9f, 0.2f, 0.12f};
    static const float LIGHTS[4][3] = {{28, 16, 6}, {8, 16, 28}, {24, 8, 12}, {12, 26, 12}};
    for (int i = 0; i < 6; i++)
        add_vertex(-6.0f + 12.0f * QUAD[i][0], 0, 0.6f + 13.4f * QUAD[i][1], FLOOR, 1, 1);
    for (int i = 0; i < 6; i++)
        add_vertex(-6.0f + 12.0f * QUAD[i][0], 6.0f * QUAD[i][1], 14.0f, WALL, 1, 1);
    add_ball(SUBJECT, 0.19f, RED, 1);
    for (int i = 0; i < 14; i++) { /* lights behind the focus distance */
        const float z = 5.0f + 0.6f * i, x = z * 0.155f * sinf(2.4f * i), y = 0.5f + z * 0.03f * cosf(1.7f * i);
        const float middle[3] = {x, y, z};
        add_ball(middle, 0.004f * z, LIGHTS[i % 4], 0);
    }
    for (int i = 0; i < 3; i++) { /* lights in front of it */
        const float middle[3] = {-0.21f + 0.17f * i, 0.51f + 0.03f * (i % 2), 1.5f};
        add_ball(middle, 0.008f, LIGHTS[(i + 2) % 4], 0);
    }
}

#endif
