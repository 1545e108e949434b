/* SPDX-License-Identifier: Apache-2.0
 *
 * Shadows' edges. In the cell of a triangle's lattice that an edge crosses, the visible share of the
 * light is found with shadow rays at the nodes of a small grid and interpolated between them. A lamp
 * without extent casts an edge without width: where the nodes about a point disagree, the point
 * itself looks at the lamp.
 */
#include "diffuse/field_parts.h"

#include "base/parallel.h"

#define SHADOW_RAYS 16
#define EDGES_A_TASK 16
/* Nodes keep this share of a cell away from its rim, which may run along a wall. */
#define INSET 0.02f

typedef struct refine_job {
    igi_field *field;
    const size_t *chosen; /* edges */
    size_t count;
} refine_job;

static bool has_extent(const igi_field *f, const edge *e)
{
    igi_light_type type = f->problem->lights[e->light].type;
    return type == IGI_LIGHT_AREA || type == IGI_LIGHT_LINE || type == IGI_LIGHT_ENV ||
           type == IGI_LIGHT_AMBIENT;
}

static float visible_share(const igi_field *f, const edge *e, igi_vec point, igi_vec normal,
                           uint64_t key)
{
    const igi_problem *p = f->problem;
    float open = igi_light_irradiance(p->lighting, NULL, e->light, point, normal, SHADOW_RAYS, key);
    if (!(open > 0)) return 0;
    int rays = has_extent(f, e) ? SHADOW_RAYS : 1;
    float seen = igi_light_irradiance(p->lighting, p->tracer, e->light, point, normal, rays, key);
    return fminf(seen / open, 1);
}

static igi_vec node_point(const igi_field *f, uint32_t side, int i, int j)
{
    const igi_patches *p = f->problem->patches;
    float step = (1 - 2 * INSET) / (NODES_ALONG - 1);
    uint32_t triangle = p->triangle[side >> 1];
    float u, v;
    igi_patch_point(p, side >> 1, INSET + step * (float)i, INSET + step * (float)j, &u, &v);
    return igi_triangle_point(p->mesh, triangle, u, v);
}

static igi_status refine_edges(igi_context *ctx, void *user, size_t task, int worker)
{
    (void)worker;
    const refine_job *job = user;
    igi_field *f = job->field;
    size_t begin = task * EDGES_A_TASK, end = begin + EDGES_A_TASK;
    if (end > job->count) end = job->count;
    for (size_t k = begin; k < end; k++) {
        const edge *e = &f->edges[job->chosen[k]];
        uint32_t side = f->rows->side[e->row];
        uint64_t key = igi_hash64(igi_seed(ctx) ^ igi_hash64((uint64_t)e->light << 32 | e->row));
        for (int j = 0; j < NODES_ALONG; j++)
            for (int i = 0; i < NODES_ALONG; i++)
                f->nodes[e->nodes + (size_t)(j * NODES_ALONG + i)] = visible_share(
                    f, e, node_point(f, side, i, j), f->normals[e->row],
                    key + (uint64_t)(j * NODES_ALONG + i));
    }
    igi_count_rays(ctx, (end - begin) * NODES_ALONG * NODES_ALONG * SHADOW_RAYS);
    return IGI_OK;
}

/* Gathered patches have no lattice of their own. */
static bool can_refine(const igi_field *f, const edge *e, uint32_t region)
{
    const igi_patches *p = f->problem->patches;
    uint32_t patch = f->rows->side[e->row] >> 1;
    const igi_triangle_lattice *l = &p->lattices[p->triangle[patch]];
    return igi_patch_region(p, patch) == region && p->next[p->triangle[patch]] == IGI_NO_HIT &&
           e->nodes == NO_NODES && l->first <= patch;
}

igi_status igi_field_refine(igi_context *ctx, igi_field *field, uint32_t region)
{
    igi_status status = IGI_OK;
    size_t *chosen = NULL, count = 0, edges = field->edge_begin[field->rows->count];
    const size_t nodes = NODES_ALONG * NODES_ALONG;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, edges, &chosen));
    for (size_t i = 0; i < edges; i++)
        if (can_refine(field, &field->edges[i], region)) chosen[count++] = i;
    void *grown = igi_grow(ctx, field->nodes, &field->node_capacity,
                           field->node_count + count * nodes, sizeof *field->nodes);
    if (!grown) IGI_TRY_GOTO(IGI_E_SYSTEM);
    field->nodes = grown;
    for (size_t k = 0; k < count; k++) {
        field->edges[chosen[k]].nodes = field->node_count;
        field->node_count += nodes;
    }
    refine_job job = {field, chosen, count};
    IGI_TRY_GOTO(
        igi_parallel_for(ctx, (count + EDGES_A_TASK - 1) / EDGES_A_TASK, refine_edges, &job));
cleanup:
    igi_free(chosen);
    return status;
}

static float clamp01(float x)
{
    return x < 0 ? 0 : x > 1 ? 1 : x;
}

float igi_field_visible(const igi_field *field, const edge *e, uint32_t triangle, float u, float v,
                        igi_vec point)
{
    if (e->nodes == NO_NODES) {
        igi_vec offset = igi_sub(point, igi_v_of(field->rows->point + 3 * (size_t)e->row));
        return clamp01(linear_at(&e->visible, offset));
    }
    float s, t, last = NODES_ALONG - 1, step = (1 - 2 * INSET) / last;
    igi_patch_place(field->problem->patches, triangle, u, v, &s, &t);
    s = fminf(clamp01((s - INSET) / (step * last)) * last, last - 1e-4f);
    t = fminf(clamp01((t - INSET) / (step * last)) * last, last - 1e-4f);
    int i = (int)s, j = (int)t;
    const float *n = field->nodes + e->nodes + j * NODES_ALONG + i;
    float corners[4] = {n[0], n[1], n[NODES_ALONG], n[NODES_ALONG + 1]};
    bool agree = corners[0] == corners[1] && corners[0] == corners[2] && corners[0] == corners[3];
    if (!agree && !has_extent(field, e))
        return visible_share(field, e, point, field->normals[e->row], 0);
    s -= (float)i;
    t -= (float)j;
    float low = corners[0] + s * (corners[1] - corners[0]);
    float high = corners[2] + s * (corners[3] - corners[2]);
    return low + t * (high - low);
}
