/* SPDX-License-Identifier: Apache-2.0 */
#include "transport/patches.h"

#include <stdlib.h>

#define MAX_CELLS_ALONG 4096
/* A triangle is gathered with others when its area is below this share of a patch's. */
#define SMALL_SHARE 0.5f

static igi_vec vertex(const igi_mesh *mesh, uint32_t triangle, int k)
{
    return igi_v_of(mesh->positions +
                    3 * (size_t)mesh->triangles[3 * (size_t)triangle + (size_t)(k % 3)]);
}

static uint16_t cells_along(float length, float size)
{
    float n = ceilf(length / size - 0.01f);
    return n < 1 ? 1 : n > MAX_CELLS_ALONG ? MAX_CELLS_ALONG : (uint16_t)n;
}

/* The corner opposite to the longest edge, so that the cells come out nearly square. */
static igi_triangle_lattice make_lattice(const igi_mesh *mesh, uint32_t triangle, float size)
{
    float edge[3];
    for (int k = 0; k < 3; k++) /* edge[k] runs from vertex k to k + 1 */
        edge[k] = igi_length(igi_sub(vertex(mesh, triangle, k + 1), vertex(mesh, triangle, k)));
    int longest = edge[1] > edge[0] ? 1 : 0;
    if (edge[2] > edge[longest]) longest = 2;
    int corner = (longest + 2) % 3;
    return (igi_triangle_lattice){.nu = cells_along(edge[corner], size),
                                  .nv = cells_along(edge[(corner + 2) % 3], size),
                                  .corner = (uint8_t)corner};
}

/* Area of the unit right triangle's part where u >= a and v >= b. */
static float beyond(float a, float b)
{
    float s = 1 - a - b;
    return s > 0 ? 0.5f * s * s : 0;
}

/* Share of the triangle's area that cell (i,j) holds, by inclusion and exclusion. */
static float cell_share(const igi_triangle_lattice *l, int i, int j)
{
    float du = 1 / (float)l->nu, dv = 1 / (float)l->nv, a = (float)i * du, b = (float)j * dv;
    float share = beyond(a, b) - beyond(a + du, b) - beyond(a, b + dv) + beyond(a + du, b + dv);
    return share > 1e-6f * du * dv ? 2 * share : 0; /* below that it is rounding */
}

/* What gathers small triangles: region, place on a grid of the patch's size, and facing. */
typedef struct key {
    uint32_t region, triangle;
    int32_t cell[3];
    int32_t facing;
} key;

static int facing_of(igi_vec n)
{
    /* the axis nearest the normal, split into quarters about it: about 24 directions */
    float c[3] = {n.x, n.y, n.z};
    int axis = fabsf(c[1]) > fabsf(c[0]) ? 1 : 0;
    if (fabsf(c[2]) > fabsf(c[axis])) axis = 2;
    int code = axis * 2 + (c[axis] < 0);
    return code * 4 + (c[(axis + 1) % 3] < 0) * 2 + (c[(axis + 2) % 3] < 0);
}

static int compare_keys(const void *pa, const void *pb)
{
    const key *a = pa, *b = pb;
    if (a->region != b->region) return a->region < b->region ? -1 : 1;
    for (int k = 0; k < 3; k++)
        if (a->cell[k] != b->cell[k]) return a->cell[k] < b->cell[k] ? -1 : 1;
    if (a->facing != b->facing) return a->facing < b->facing ? -1 : 1;
    return a->triangle < b->triangle ? -1 : 1;
}

static bool same_group(const key *a, const key *b)
{
    return a->region == b->region && a->facing == b->facing && a->cell[0] == b->cell[0] &&
           a->cell[1] == b->cell[1] && a->cell[2] == b->cell[2];
}

static key make_key(const igi_mesh *mesh, uint32_t triangle, float size)
{
    igi_vec c = igi_triangle_point(mesh, triangle, 1.0f / 3, 1.0f / 3);
    return (key){.region = mesh->regions[triangle],
                 .triangle = triangle,
                 .cell = {(int32_t)floorf(c.x / size), (int32_t)floorf(c.y / size),
                          (int32_t)floorf(c.z / size)},
                 .facing = facing_of(igi_triangle_normal(mesh, triangle))};
}

/* Gives every triangle its lattice and its first patch; small ones, sorted by key, share one. */
static igi_status number_patches(igi_context *ctx, igi_patches *p)
{
    const igi_mesh *mesh = p->mesh;
    float small = SMALL_SHARE * p->size_m * p->size_m;
    key *keys;
    IGI_TRY(IGI_ALLOC(ctx, mesh->triangle_count, &keys));
    size_t count = 0, small_count = 0;
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        p->next[t] = IGI_NO_HIT;
        p->lattices[t] = make_lattice(mesh, t, p->size_m);
        if (igi_triangle_area(mesh, t) < small) {
            p->lattices[t].nu = p->lattices[t].nv = 1;
            keys[small_count++] = make_key(mesh, t, p->size_m);
        } else {
            p->lattices[t].first = (uint32_t)count;
            count += (size_t)p->lattices[t].nu * p->lattices[t].nv;
        }
    }
    qsort(keys, small_count, sizeof *keys, compare_keys);
    for (size_t i = 0; i < small_count; i++) {
        if (i > 0 && same_group(&keys[i - 1], &keys[i]))
            p->next[keys[i - 1].triangle] = keys[i].triangle;
        else count++;
        p->lattices[keys[i].triangle].first = (uint32_t)(count - 1);
    }
    igi_free(keys);
    p->count = count;
    if (count >= UINT32_MAX / 4)
        return igi_fail(ctx, IGI_E_DATA,
                        "mesh: %zu patches of %g m are too many; ask for larger ones", count,
                        (double)p->size_m);
    return IGI_OK;
}

static void fill_areas(igi_patches *p)
{
    for (size_t i = 0; i < p->count; i++) p->triangle[i] = IGI_NO_HIT;
    for (uint32_t t = 0; t < p->mesh->triangle_count; t++) {
        const igi_triangle_lattice *l = &p->lattices[t];
        float area = igi_triangle_area(p->mesh, t);
        for (int j = 0; j < l->nv; j++)
            for (int i = 0; i < l->nu; i++) {
                size_t patch = l->first + (size_t)j * l->nu + (size_t)i;
                p->area[patch] += l->nu * l->nv == 1 ? area : area * cell_share(l, i, j);
                /* the gathered ones are linked in rising order, so the lowest comes first */
                if (p->triangle[patch] == IGI_NO_HIT) p->triangle[patch] = t;
            }
    }
}

igi_status igi_patches_create(igi_context *ctx, const igi_mesh *mesh, float size_m,
                              igi_patches **patches)
{
    igi_patches *p = NULL;
    igi_status status = IGI_OK;
    *patches = NULL;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 1, &p));
    p->mesh = mesh;
    p->size_m = size_m;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, mesh->triangle_count, &p->lattices));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, mesh->triangle_count, &p->next));
    IGI_TRY_GOTO(number_patches(ctx, p));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, p->count, &p->triangle));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, p->count, &p->area));
    fill_areas(p);
    *patches = p;
    p = NULL;
cleanup:
    igi_patches_destroy(p);
    return status;
}

void igi_patches_destroy(igi_patches *patches)
{
    if (!patches) return;
    igi_free(patches->lattices);
    igi_free(patches->next);
    igi_free(patches->triangle);
    igi_free(patches->area);
    igi_free(patches);
}

/* Barycentric weights turned so that the lattice's corner is the first. */
static void to_lattice(const igi_triangle_lattice *l, float u, float v, float *s, float *t)
{
    float w = 1 - u - v;
    *s = l->corner == 0 ? u : l->corner == 1 ? v : w;
    *t = l->corner == 0 ? v : l->corner == 1 ? w : u;
}

static void from_lattice(const igi_triangle_lattice *l, float s, float t, float *u, float *v)
{
    float w[3];
    w[l->corner] = 1 - s - t;
    w[(l->corner + 1) % 3] = s;
    w[(l->corner + 2) % 3] = t;
    *u = w[1];
    *v = w[2];
}

uint32_t igi_patch_at(const igi_patches *patches, uint32_t triangle, float u, float v)
{
    const igi_triangle_lattice *l = &patches->lattices[triangle];
    if (l->nu == 1 && l->nv == 1) return l->first;
    float s, t;
    to_lattice(l, u, v, &s, &t);
    int i = (int)(s * (float)l->nu), j = (int)(t * (float)l->nv);
    i = i < 0 ? 0 : i >= l->nu ? l->nu - 1 : i;
    j = j < 0 ? 0 : j >= l->nv ? l->nv - 1 : j;
    uint32_t patch = l->first + (uint32_t)j * l->nu + (uint32_t)i;
    /* rounding on the long edge may fall into a cell of no area: its neighbour holds the point */
    bool beside = (i + 1) * l->nv + (j + 1) * l->nu > l->nu * l->nv;
    if (beside && patches->area[patch] <= 0) patch -= i > 0 ? 1 : l->nu;
    return patch;
}

void igi_patch_place(const igi_patches *patches, uint32_t triangle, float u, float v, float *s,
                     float *t)
{
    const igi_triangle_lattice *l = &patches->lattices[triangle];
    uint32_t cell = igi_patch_at(patches, triangle, u, v) - l->first;
    to_lattice(l, u, v, s, t);
    *s = *s * (float)l->nu - (float)(cell % l->nu);
    *t = *t * (float)l->nv - (float)(cell / l->nu);
}

void igi_patch_point(const igi_patches *patches, uint32_t patch, float s, float t, float *u,
                     float *v)
{
    const igi_triangle_lattice *l = &patches->lattices[patches->triangle[patch]];
    uint32_t cell = patch - l->first;
    float a = ((float)(cell % l->nu) + s) / (float)l->nu,
          b = ((float)(cell / l->nu) + t) / (float)l->nv;
    float excess = fmaxf(0.0f, a + b - 1) / 2;
    from_lattice(l, fmaxf(0.0f, a - excess), fmaxf(0.0f, b - excess), u, v);
}

static uint32_t pick_gathered(const igi_patches *p, uint32_t patch, igi_rng *rng)
{
    uint32_t triangle = p->triangle[patch];
    float left = igi_rng_float(rng) * p->area[patch];
    while (p->next[triangle] != IGI_NO_HIT) {
        left -= igi_triangle_area(p->mesh, triangle);
        if (left < 0) break;
        triangle = p->next[triangle];
    }
    return triangle;
}

void igi_patch_sample(const igi_patches *patches, uint32_t patch, igi_rng *rng, uint32_t *triangle,
                      float *u, float *v)
{
    *triangle = pick_gathered(patches, patch, rng);
    const igi_triangle_lattice *l = &patches->lattices[*triangle];
    uint32_t cell = patch - l->first;
    float s = 0, t = 0;
    for (int attempt = 0; attempt < 64;
         attempt++) { /* a cell holds a corner of the triangle at least */
        s = ((float)(cell % l->nu) + igi_rng_float(rng)) / (float)l->nu;
        t = ((float)(cell / l->nu) + igi_rng_float(rng)) / (float)l->nv;
        if (s + t <= 1) break;
    }
    if (s + t > 1) { /* a sliver: its inner corner will do */
        s = (float)(cell % l->nu) / (float)l->nu;
        t = (float)(cell / l->nu) / (float)l->nv;
    }
    from_lattice(l, s, t, u, v);
}
