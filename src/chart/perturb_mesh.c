/* SPDX-License-Identifier: Apache-2.0
 *
 * A mesh that is not what stood there. Vertices at one place move together: what a vertex does
 * depends on where it is.
 */
#include "chart/sweep.h"
#include "scene/mesh.h"

#include <string.h>

static uint64_t place_key(const float *p, uint64_t key)
{
    for (int k = 0; k < 3; k++)
        key = igi_hash64(key ^ (uint64_t)(int64_t)floor((double)p[k] * 1e4 + .5));
    return key;
}

static uint64_t stream_key(const chart_subject *s, const char *what)
{
    igi_rng rng = chart_stream(s, what);
    uint32_t high = igi_rng_next(&rng);
    return (uint64_t)high << 32 | igi_rng_next(&rng);
}

/* A unit vector, even over the sphere. */
static igi_vec random_direction(uint64_t key)
{
    igi_rng rng = igi_rng_make(key, 0);
    double z = 1 - 2 * (double)igi_rng_float(&rng), turn = 2 * IGI_PI * (double)igi_rng_float(&rng);
    double r = sqrt(fmax(0, 1 - z * z));
    return igi_v((float)(r * cos(turn)), (float)(r * sin(turn)), (float)z);
}

static void move_vertex(float *p, igi_vec d, double by)
{
    p[0] += (float)by * d.x;
    p[1] += (float)by * d.y;
    p[2] += (float)by * d.z;
}

/* Every vertex off by `severity` metres in a direction of its own. */
static igi_status displace(igi_context *ctx, const chart_change *c, double severity,
                           chart_subject *s)
{
    (void)ctx;
    uint64_t key = stream_key(s, c->kind->name);
    for (size_t i = 0; i < s->scene->mesh.vertex_count; i++) {
        float *p = s->scene->mesh.positions + 3 * i;
        move_vertex(p, random_direction(place_key(p, key)), severity);
    }
    return IGI_OK;
}

/* The mesh larger than the cameras' world by the share `severity`, about its middle. */
static igi_status scale(igi_context *ctx, const chart_change *c, double severity, chart_subject *s)
{
    (void)ctx;
    (void)c;
    igi_mesh *mesh = &s->scene->mesh;
    igi_box box = igi_mesh_box(mesh);
    igi_vec middle = igi_scale(igi_add(box.low, box.high), .5f);
    for (size_t i = 0; i < mesh->vertex_count; i++) {
        float *p = mesh->positions + 3 * i;
        move_vertex(p, igi_sub(igi_v_of(p), middle), severity);
    }
    return IGI_OK;
}

/* The named regions pushed sideways by `severity` metres. */
static igi_status move(igi_context *ctx, const chart_change *c, double severity, chart_subject *s)
{
    igi_mesh *mesh = &s->scene->mesh;
    bool *moves;
    size_t found = 0;
    igi_vec d = random_direction(stream_key(s, c->kind->name));
    d = igi_normalize(igi_v(d.x, d.y, 0));
    IGI_TRY(IGI_ALLOC(ctx, mesh->vertex_count, &moves));
    for (size_t k = 0; k < c->region_count; k++) {
        size_t region = chart_region(s->scene, c->regions[k]);
        for (size_t t = 0; t < mesh->triangle_count; t++)
            for (int i = 0; i < 3 && mesh->regions[t] == region; i++, found++)
                moves[mesh->triangles[3 * t + (size_t)i]] = true;
    }
    for (size_t i = 0; i < mesh->vertex_count; i++)
        if (moves[i]) move_vertex(mesh->positions + 3 * i, d, severity);
    igi_free(moves);
    return found ? IGI_OK : IGI_E_NO_ANSWER;
}

/* Room for `more` triangles with vertices of their own. */
static igi_status enlarge(igi_context *ctx, igi_mesh *mesh, size_t more)
{
    size_t old = mesh->triangle_count, triangles = old + more,
           vertices = mesh->vertex_count + 3 * more;
    float *positions = NULL, *uvs = NULL;
    uint32_t *indices = NULL, *regions = NULL;
    igi_status status = IGI_OK;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 3 * vertices, &positions));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 3 * triangles, &indices));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, triangles, &regions));
    if (mesh->uvs) IGI_TRY_GOTO(IGI_ALLOC(ctx, 6 * triangles, &uvs));
    memcpy(positions, mesh->positions, 3 * mesh->vertex_count * sizeof *positions);
    memcpy(indices, mesh->triangles, 3 * old * sizeof *indices);
    memcpy(regions, mesh->regions, old * sizeof *regions);
    if (uvs) memcpy(uvs, mesh->uvs, 6 * old * sizeof *uvs);
    igi_free(mesh->positions);
    igi_free(mesh->triangles);
    igi_free(mesh->regions);
    igi_free(mesh->uvs);
    mesh->positions = positions;
    mesh->triangles = indices;
    mesh->regions = regions;
    mesh->uvs = uvs;
    return IGI_OK;
cleanup:
    igi_free(positions);
    igi_free(indices);
    igi_free(regions);
    igi_free(uvs);
    return status;
}

/* A copy of triangle t with vertices of its own, at the end. */
static void copy_triangle(igi_mesh *mesh, size_t t, const igi_vec corners[3])
{
    size_t to = mesh->triangle_count++;
    for (int i = 0; i < 3; i++) {
        size_t v = mesh->vertex_count++;
        mesh->positions[3 * v] = corners[i].x;
        mesh->positions[3 * v + 1] = corners[i].y;
        mesh->positions[3 * v + 2] = corners[i].z;
        mesh->triangles[3 * to + (size_t)i] = (uint32_t)v;
    }
    mesh->regions[to] = mesh->regions[t];
    if (mesh->uvs) memcpy(mesh->uvs + 6 * to, mesh->uvs + 6 * t, 6 * sizeof *mesh->uvs);
}

static void corners_of(const igi_mesh *mesh, size_t t, igi_vec corners[3])
{
    for (int i = 0; i < 3; i++)
        corners[i] = igi_v_of(mesh->positions + 3 * (size_t)mesh->triangles[3 * t + (size_t)i]);
}

/* The first `count` triangles are dropped. */
static void drop_first(igi_mesh *mesh, size_t count)
{
    size_t keep = mesh->triangle_count - count;
    memmove(mesh->triangles, mesh->triangles + 3 * count, 3 * keep * sizeof *mesh->triangles);
    memmove(mesh->regions, mesh->regions + count, keep * sizeof *mesh->regions);
    if (mesh->uvs) memmove(mesh->uvs, mesh->uvs + 6 * count, 6 * keep * sizeof *mesh->uvs);
    mesh->triangle_count = keep;
}

/* Triangles no longer meet: each edge drawn in by about `severity` metres. */
static igi_status crack(igi_context *ctx, const chart_change *c, double severity, chart_subject *s)
{
    (void)c;
    igi_mesh *mesh = &s->scene->mesh;
    size_t count = mesh->triangle_count;
    if (severity <= 0) return IGI_OK;
    IGI_TRY(enlarge(ctx, mesh, count));
    for (size_t t = 0; t < count; t++) {
        igi_vec p[3];
        corners_of(mesh, t, p);
        float around = igi_length(igi_sub(p[1], p[0])) + igi_length(igi_sub(p[2], p[1])) +
                       igi_length(igi_sub(p[0], p[2]));
        float inradius = 2 * igi_triangle_area(mesh, (uint32_t)t) / around;
        float keep = fmaxf(0.1f, 1 - (float)severity / inradius);
        igi_vec middle = igi_scale(igi_add(p[0], igi_add(p[1], p[2])), 1 / 3.0f);
        for (int i = 0; i < 3; i++) p[i] = igi_madd(middle, igi_sub(p[i], middle), keep);
        copy_triangle(mesh, t, p);
    }
    drop_first(mesh, count);
    return IGI_OK;
}

static bool is_emitter(const igi_scene *scene, size_t t)
{
    return scene->regions[scene->mesh.regions[t]].emitter;
}

static bool is_drawn(uint64_t key, size_t t, double share)
{
    return (double)(igi_hash64(key ^ igi_hash64(t)) >> 11) * 0x1p-53 < share;
}

/* `severity` of the triangles show their other side. */
static igi_status flip(igi_context *ctx, const chart_change *c, double severity, chart_subject *s)
{
    (void)ctx;
    igi_mesh *mesh = &s->scene->mesh;
    uint64_t key = stream_key(s, c->kind->name);
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        if (is_emitter(s->scene, t) || !is_drawn(key, t, severity)) continue;
        uint32_t *v = mesh->triangles + 3 * t, kept = v[1];
        v[1] = v[2];
        v[2] = kept;
        for (int k = 0; k < 2 && mesh->uvs; k++) {
            float *uv = mesh->uvs + 6 * t, old = uv[2 + k];
            uv[2 + k] = uv[4 + k];
            uv[4 + k] = old;
        }
    }
    return IGI_OK;
}

/* `severity` of the triangles are there twice, the second `size` metres in front. */
static igi_status twice(igi_context *ctx, const chart_change *c, double severity, chart_subject *s)
{
    igi_mesh *mesh = &s->scene->mesh;
    size_t count = mesh->triangle_count;
    uint64_t key = stream_key(s, c->kind->name);
    IGI_TRY(enlarge(ctx, mesh, count));
    for (size_t t = 0; t < count; t++) {
        igi_vec p[3], n = igi_triangle_normal(mesh, (uint32_t)t);
        if (is_emitter(s->scene, t) || !is_drawn(key, t, severity)) continue;
        corners_of(mesh, t, p);
        for (int i = 0; i < 3; i++) p[i] = igi_madd(p[i], n, (float)c->size);
        copy_triangle(mesh, t, p);
    }
    return IGI_OK;
}

/* The outlines of lamps drawn too large by the share `severity` (too small where it is negative),
 * together with what borders on them. */
static igi_status outline(igi_context *ctx, const chart_change *c, double severity,
                          chart_subject *s)
{
    (void)ctx;
    (void)c;
    igi_mesh *mesh = &s->scene->mesh;
    igi_box lamps = igi_box_empty();
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        igi_vec p[3];
        corners_of(mesh, t, p);
        for (int i = 0; i < 3 && is_emitter(s->scene, t); i++) igi_box_add(&lamps, p[i]);
    }
    igi_vec low = lamps.low, high = lamps.high;
    if (!(low.x <= high.x)) return IGI_E_NO_ANSWER;
    igi_vec middle = igi_scale(igi_add(low, high), .5f);
    float slack = 1e-4f * igi_length(igi_sub(high, low));
    for (size_t i = 0; i < mesh->vertex_count; i++) {
        float *p = mesh->positions + 3 * i;
        if (p[0] < low.x - slack || p[1] < low.y - slack || p[2] < low.z - slack ||
            p[0] > high.x + slack || p[1] > high.y + slack || p[2] > high.z + slack)
            continue;
        move_vertex(p, igi_sub(igi_v_of(p), middle), severity);
    }
    return IGI_OK;
}

const chart_perturbation chart_perturb_mesh[] = {
    {"displace", false, displace},    {"scale-mesh", false, scale}, {"move", false, move},
    {"crack", false, crack},          {"flip", false, flip},        {"double", false, twice},
    {"lamp-outline", false, outline}, {NULL, false, NULL}};
