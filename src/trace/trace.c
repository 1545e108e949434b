/* SPDX-License-Identifier: Apache-2.0
 *
 * One Embree scene of one triangle mesh. Embree 3 and 4 differ in header, in the ray's context and
 * in nothing else that is used here. Embree reports errors to a callback; what it says is kept with
 * the tracer while it is built, and becomes the sentence of the failure.
 */
#include "trace/trace.h"

#include "scene/mesh.h"

#if IGI_EMBREE_MAJOR >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <float.h>
#include <stdio.h>

/* Of the scene's size. The latter is ten times what a point on a triangle is off it in floats where the
 * scene lies about the origin; far from there floats are coarser, and both are so many grains. */
#define EPSILON 2e-5f
#define OFF_SURFACE 2e-6f
#define GRAINS 4

struct igi_tracer {
    const igi_mesh *mesh;
    igi_vec *normals; /* [triangle_count] */
    RTCDevice device;
    RTCScene scene;
    igi_box box;
    float size;
    float epsilon,
        off_surface; /* metres: what a ray does not see in front of it; what it starts above */
    char error[256];
};

static void keep_error(void *user, enum RTCError code, const char *sentence)
{
    igi_tracer *tracer = user;
    snprintf(tracer->error, sizeof tracer->error, "Embree error %d: %s", (int)code,
             sentence ? sentence : "");
}

static void find_bounds(igi_tracer *tracer)
{
    tracer->box = igi_mesh_box(tracer->mesh);
    tracer->size = igi_box_diagonal(&tracer->box);
    igi_vec low = tracer->box.low, high = tracer->box.high;
    igi_vec far = igi_v(fmaxf(-low.x, high.x), fmaxf(-low.y, high.y), fmaxf(-low.z, high.z));
    float grain = GRAINS * FLT_EPSILON * fmaxf(far.x, fmaxf(far.y, far.z));
    tracer->epsilon = fmaxf(EPSILON * tracer->size, grain);
    tracer->off_surface = fmaxf(OFF_SURFACE * tracer->size, grain);
}

/* Embree reads 16 bytes at the last vertex, so the positions are copied into a padded buffer. */
static void attach_mesh(igi_tracer *tracer)
{
    const igi_mesh *mesh = tracer->mesh;
    RTCGeometry geometry = rtcNewGeometry(tracer->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    float *positions = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0,
                                               RTC_FORMAT_FLOAT3, 3 * sizeof(float),
                                               mesh->vertex_count);
    for (size_t i = 0; positions && i < 3 * mesh->vertex_count; i++)
        positions[i] = mesh->positions[i];
    uint32_t *indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0,
                                                RTC_FORMAT_UINT3, 3 * sizeof(uint32_t),
                                                mesh->triangle_count);
    for (size_t i = 0; indices && i < 3 * mesh->triangle_count; i++)
        indices[i] = mesh->triangles[i];
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(tracer->scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcSetSceneFlags(tracer->scene, RTC_SCENE_FLAG_ROBUST); /* rays must not slip through edges */
    rtcCommitScene(tracer->scene);
}

igi_status igi_tracer_create(igi_context *ctx, const igi_mesh *mesh, igi_tracer **tracer)
{
    igi_tracer *t;
    *tracer = NULL;
    IGI_TRY(IGI_ALLOC(ctx, 1, &t));
    if (IGI_ALLOC(ctx, mesh->triangle_count, &t->normals) != IGI_OK) {
        igi_tracer_destroy(t);
        return IGI_E_SYSTEM;
    }
    t->mesh = mesh;
    find_bounds(t);
    for (uint32_t i = 0; i < mesh->triangle_count; i++)
        t->normals[i] = igi_triangle_normal(mesh, i);
    char config[64];
    snprintf(config, sizeof config, "threads=%d,set_affinity=0", igi_threads(ctx));
    t->device = rtcNewDevice(config);
    if (t->device) {
        rtcSetDeviceErrorFunction(t->device, keep_error, t);
        t->scene = rtcNewScene(t->device);
        attach_mesh(t);
    } else {
        keep_error(t, rtcGetDeviceError(NULL), "no device");
    }
    if (!t->error[0]) {
        *tracer = t;
        return IGI_OK;
    }
    igi_status status = igi_fail(ctx, IGI_E_SYSTEM, "mesh: %s; is there enough memory?", t->error);
    igi_tracer_destroy(t);
    return status;
}

void igi_tracer_destroy(igi_tracer *tracer)
{
    if (!tracer) return;
    if (tracer->scene) rtcReleaseScene(tracer->scene);
    if (tracer->device) rtcReleaseDevice(tracer->device);
    igi_free(tracer->normals);
    igi_free(tracer);
}

static struct RTCRay make_ray(igi_vec origin, igi_vec direction, float near, float far)
{
    return (struct RTCRay){.org_x = origin.x,
                           .org_y = origin.y,
                           .org_z = origin.z,
                           .dir_x = direction.x,
                           .dir_y = direction.y,
                           .dir_z = direction.z,
                           .tnear = near,
                           .tfar = far,
                           .mask = UINT32_MAX};
}

/* Debian's Embree ends the program on a ray that is not finite. Such a ray meets nothing. */
static bool is_ray(igi_vec origin, igi_vec direction)
{
    return isfinite(origin.x + origin.y + origin.z + direction.x + direction.y + direction.z);
}

static igi_hit nearest(const igi_tracer *tracer, igi_vec origin, igi_vec direction, float near)
{
    if (!is_ray(origin, direction)) return (igi_hit){.triangle = IGI_NO_HIT, .distance = INFINITY};
    struct RTCRayHit r = {
        .ray = make_ray(origin, direction, near, INFINITY),
        .hit = {.geomID = RTC_INVALID_GEOMETRY_ID, .primID = RTC_INVALID_GEOMETRY_ID}};
#if IGI_EMBREE_MAJOR >= 4
    rtcIntersect1(tracer->scene, &r, NULL);
#else
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(tracer->scene, &context, &r);
#endif
    if (r.hit.geomID == RTC_INVALID_GEOMETRY_ID)
        return (igi_hit){.triangle = IGI_NO_HIT, .distance = INFINITY};
    /* Embree's Ng is on the counter-clockwise side. */
    float facing = r.hit.Ng_x * direction.x + r.hit.Ng_y * direction.y + r.hit.Ng_z * direction.z;
    return (igi_hit){.triangle = r.hit.primID,
                     .u = r.hit.u,
                     .v = r.hit.v,
                     .distance = r.ray.tfar,
                     .back = facing > 0};
}

igi_hit igi_trace(const igi_tracer *tracer, igi_vec origin, igi_vec direction)
{
    return nearest(tracer, origin, direction, tracer->epsilon);
}

void igi_trace_bundle(const igi_tracer *tracer, igi_vec origin, const igi_vec *directions,
                      int count, igi_hit *hits)
{
    struct RTCRayHit8 r;
    _Alignas(32) int valid[IGI_TRACE_BUNDLE]; /* Embree asks for it */
    for (int i = 0; i < IGI_TRACE_BUNDLE; i++) {
        igi_vec d = directions[i < count ? i : 0];
        valid[i] = i < count && is_ray(origin, d) ? -1 : 0;
        r.ray.org_x[i] = origin.x;
        r.ray.org_y[i] = origin.y;
        r.ray.org_z[i] = origin.z;
        r.ray.dir_x[i] = d.x;
        r.ray.dir_y[i] = d.y;
        r.ray.dir_z[i] = d.z;
        r.ray.tnear[i] = tracer->epsilon;
        r.ray.tfar[i] = INFINITY;
        r.ray.time[i] = 0;
        r.ray.mask[i] = UINT32_MAX;
        r.ray.id[i] = r.ray.flags[i] = 0;
        r.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
    }
#if IGI_EMBREE_MAJOR >= 4
    struct RTCIntersectArguments arguments;
    rtcInitIntersectArguments(&arguments);
    arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
    rtcIntersect8(valid, tracer->scene, &r, &arguments);
#else
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    rtcIntersect8(valid, tracer->scene, &context, &r);
#endif
    for (int i = 0; i < count; i++) {
        hits[i] = (igi_hit){.triangle = IGI_NO_HIT, .distance = INFINITY};
        if (r.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) continue;
        igi_vec normal = igi_v(r.hit.Ng_x[i], r.hit.Ng_y[i], r.hit.Ng_z[i]);
        hits[i] = (igi_hit){.triangle = r.hit.primID[i],
                            .u = r.hit.u[i],
                            .v = r.hit.v[i],
                            .distance = r.ray.tfar[i],
                            .back = igi_dot(normal, directions[i]) > 0};
    }
}

igi_hit igi_trace_off(const igi_tracer *tracer, igi_vec point, igi_vec normal, igi_vec direction)
{
    return nearest(tracer, igi_madd(point, normal, tracer->off_surface), direction, 0);
}

bool igi_occluded_toward(const igi_tracer *tracer, igi_vec from, igi_vec direction, float limit)
{
    if (!is_ray(from, direction) || isnan(limit)) return false;
    struct RTCRay r = make_ray(from, direction, tracer->epsilon, limit);
#if IGI_EMBREE_MAJOR >= 4
    rtcOccluded1(tracer->scene, &r, NULL);
#else
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(tracer->scene, &context, &r);
#endif
    return r.tfar < 0; /* Embree sets -infinity on a hit */
}

bool igi_occluded(const igi_tracer *tracer, igi_vec from, igi_vec to)
{
    igi_vec d = igi_sub(to, from);
    float distance = igi_length(d);
    float limit = distance - tracer->epsilon;
    if (limit <= tracer->epsilon) return false;
    return igi_occluded_toward(tracer, from, igi_scale(d, 1 / distance), limit);
}

float igi_tracer_size(const igi_tracer *tracer, igi_vec *low, igi_vec *high)
{
    if (low) *low = tracer->box.low;
    if (high) *high = tracer->box.high;
    return tracer->size;
}

float igi_tracer_epsilon(const igi_tracer *tracer)
{
    return tracer->epsilon;
}

igi_vec igi_tracer_normal(const igi_tracer *tracer, uint32_t triangle)
{
    return tracer->normals[triangle];
}
