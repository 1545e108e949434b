/* SPDX-License-Identifier: Apache-2.0
 *
 * Splitting: a triangle much larger than an element becomes n^2 equal ones on its barycentric
 * lattice. Row j of the lattice (v from j/n to (j+1)/n) holds 2(n-j)-1 facets, so that facet
 * (i, j, upper) has number 2nj - j^2 + 2i + upper: the one at (u,v) is found without a search.
 * Merging: small triangles are sorted by region, direction of their normal and cell of a grid; each
 * group is one element. Neither needs the triangles to share vertices, or to be watertight.
 */
#include "transport/mesh_elements.h"

#include <stdlib.h>
#include <string.h>

typedef struct small_triangle {
    uint32_t region;
    int32_t key[6]; /* normal, cell */
    uint32_t triangle;
} small_triangle;

typedef struct maker {
    const igi_mesh *mesh;
    double low[3], extent; /* of the triangles that have area */
    size_t split_facets, small_count, groups;
    small_triangle *small; /* [triangle_count] */
    igi_elements *out;
} maker;

/* Twice the area; the unit normal (zero where there is none). */
static double find_normal(const igi_facet *f, double normal[3])
{
    double a[3], b[3], length2 = 0;
    for (int k = 0; k < 3; k++) {
        a[k] = f->corner[1][k] - f->corner[0][k];
        b[k] = f->corner[2][k] - f->corner[0][k];
    }
    for (int k = 0; k < 3; k++) {
        normal[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
        length2 += normal[k] * normal[k];
    }
    double length = sqrt(length2);
    for (int k = 0; k < 3; k++) normal[k] = length > 0 ? normal[k] / length : 0;
    return length;
}

static double longest_edge(const igi_facet *f)
{
    double longest = 0;
    for (int c = 0; c < 3; c++) {
        double sum = 0;
        for (int k = 0; k < 3; k++) {
            double d = f->corner[(c + 1) % 3][k] - f->corner[c][k];
            sum += d * d;
        }
        longest = fmax(longest, sqrt(sum));
    }
    return longest;
}

static igi_facet facet_of_triangle(const igi_mesh *mesh, size_t triangle)
{
    igi_facet f = {.triangle = (uint32_t)triangle};
    for (size_t c = 0; c < 3; c++) {
        const float *p = mesh->positions + 3 * (size_t)mesh->triangles[3 * triangle + c];
        for (int k = 0; k < 3; k++) f.corner[c][k] = (double)p[k];
    }
    find_normal(&f, f.normal);
    return f;
}

/* Facets along an edge; 0 for a triangle whose height is lost in the rounding of its corners. */
static double divisions_of(const igi_facet *f, double size)
{
    double normal[3], twice = find_normal(f, normal), edge = longest_edge(f);
    if (!(twice > 1e-7 * edge * edge) || !isfinite(edge)) return 0;
    return ceil(fmax(sqrt(0.5 * twice), edge / 3) / size);
}

static void find_extent(maker *m)
{
    double high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}, sum = 0;
    for (int k = 0; k < 3; k++) m->low[k] = HUGE_VAL;
    for (size_t t = 0; t < m->mesh->triangle_count; t++) {
        igi_facet f = facet_of_triangle(m->mesh, t);
        if (divisions_of(&f, 1) == 0) continue;
        for (int i = 0; i < 9; i++) {
            m->low[i % 3] = fmin(m->low[i % 3], f.corner[i / 3][i % 3]);
            high[i % 3] = fmax(high[i % 3], f.corner[i / 3][i % 3]);
        }
    }
    for (int k = 0; k < 3; k++) sum += (high[k] - m->low[k]) * (high[k] - m->low[k]);
    m->extent = sqrt(sum);
}

static int compare_small(const void *a, const void *b)
{
    const small_triangle *x = a, *y = b;
    if (x->region != y->region) return x->region < y->region ? -1 : 1;
    for (int k = 0; k < 6; k++)
        if (x->key[k] != y->key[k]) return x->key[k] < y->key[k] ? -1 : 1;
    return x->triangle < y->triangle ? -1 : x->triangle > y->triangle;
}

static bool same_group(const small_triangle *a, const small_triangle *b)
{
    return a->region == b->region && memcmp(a->key, b->key, sizeof a->key) == 0;
}

/* The grid is shifted by an odd fraction of a cell: walls tend to lie on round numbers. */
static small_triangle describe(const maker *m, const igi_facet *f, double size)
{
    small_triangle s = {.region = m->mesh->regions[f->triangle], .triangle = f->triangle};
    for (int k = 0; k < 3; k++) {
        double c = (f->corner[0][k] + f->corner[1][k] + f->corner[2][k]) / 3;
        s.key[k] = (int32_t)lround(2 * f->normal[k]);
        s.key[3 + k] = (int32_t)floor((c - m->low[k]) / size + 0.37);
    }
    return s;
}

/* Decides, for this size, what is split and what is merged; fills out->divisions and small. */
static void plan(maker *m, double size, size_t limit)
{
    m->split_facets = m->small_count = m->groups = 0;
    for (size_t t = 0; t < m->mesh->triangle_count; t++) {
        igi_facet f = facet_of_triangle(m->mesh, t);
        double n = divisions_of(&f, size);
        m->out->divisions[t] = (uint16_t)fmin(n, 65535);
        if (n > 1) m->split_facets += (size_t)fmin(n * n, (double)limit + 1);
        if (n == 1) m->small[m->small_count++] = describe(m, &f, size);
        if (m->split_facets > limit) return;
    }
    qsort(m->small, m->small_count, sizeof *m->small, compare_small);
    for (size_t i = 0; i < m->small_count; i++)
        if (i == 0 || !same_group(&m->small[i - 1], &m->small[i])) m->groups++;
}

static igi_status plan_within(igi_context *ctx, maker *m, double size, size_t limit)
{
    find_extent(m);
    if (!(m->extent > 0) || !isfinite(m->extent))
        return igi_fail(ctx, IGI_E_DATA, "mesh: no triangle has area; check its vertices");
    for (size = fmax(size, 1e-6 * m->extent);; size *= 1.2) {
        plan(m, size, limit);
        if (m->split_facets + m->groups <= limit) return IGI_OK;
        if (size > 4 * m->extent)
            return igi_fail(ctx, IGI_E_DATA,
                            "mesh: it has more than %zu pieces of different region or direction; "
                            "use the method 'patches'",
                            limit);
    }
}

static igi_element *open_element(igi_elements *out, uint32_t region)
{
    igi_element *e = &out->elements[out->count++];
    e->region = region;
    e->first_facet = (uint32_t)out->facet_count;
    return e;
}

static void add_facet(igi_elements *out, igi_element *e, const igi_facet *facet)
{
    igi_facet *f = &out->facets[out->facet_count++];
    *f = *facet;
    f->element[0] = f->element[1] = (uint32_t)(e - out->elements);
    double area = igi_facet_area(f);
    e->area += area;
    f->area_so_far = e->area;
    for (int k = 0; k < 3; k++) {
        e->centre[k] += area * (f->corner[0][k] + f->corner[1][k] + f->corner[2][k]) / 3;
        e->normal[k] += area * f->normal[k];
    }
    e->facet_count++;
}

/* Ends an element whose facets are all there: sums become means. */
static void close_element(const igi_elements *out, igi_element *e)
{
    double length2 = 0;
    for (int k = 0; k < 3; k++) length2 += e->normal[k] * e->normal[k];
    double length = sqrt(length2);
    for (int k = 0; k < 3; k++) {
        e->centre[k] /= e->area;
        e->normal[k] = length > 0 ? e->normal[k] / length : out->facets[e->first_facet].normal[k];
    }
}

static igi_facet lattice_facet(const igi_facet *whole, int n, int i, int j, bool upper)
{
    const int lattice[2][3][2] = {{{i, j}, {i + 1, j}, {i, j + 1}},
                                  {{i + 1, j + 1}, {i, j + 1}, {i + 1, j}}};
    igi_facet f = *whole;
    for (int c = 0; c < 3; c++) {
        double u = (double)lattice[upper][c][0] / n, v = (double)lattice[upper][c][1] / n;
        for (int k = 0; k < 3; k++)
            f.corner[c][k] = (1 - u - v) * whole->corner[0][k] + u * whole->corner[1][k] +
                             v * whole->corner[2][k];
    }
    return f;
}

static void split_triangle(maker *m, size_t t)
{
    igi_elements *out = m->out;
    igi_facet whole = facet_of_triangle(m->mesh, t);
    int n = out->divisions[t];
    out->first_facet[t] = (uint32_t)out->facet_count;
    for (int j = 0; j < n; j++) {
        for (int i = 0; i < 2 * (n - j) - 1; i++) {
            igi_facet f = lattice_facet(&whole, n, i / 2, j, i % 2);
            igi_element *e = open_element(out, m->mesh->regions[t]);
            add_facet(out, e, &f);
            close_element(out, e);
        }
    }
}

static void merge_small(maker *m)
{
    igi_elements *out = m->out;
    igi_element *e = NULL;
    for (size_t i = 0; i < m->small_count; i++) {
        const small_triangle *s = &m->small[i];
        if (i == 0 || !same_group(s - 1, s)) {
            if (e) close_element(out, e);
            e = open_element(out, s->region);
        }
        igi_facet f = facet_of_triangle(m->mesh, s->triangle);
        out->first_facet[s->triangle] = (uint32_t)out->facet_count;
        add_facet(out, e, &f);
    }
    if (e) close_element(out, e);
}

static void add_backs(igi_elements *out)
{
    size_t fronts = out->count;
    for (size_t i = 0; i < fronts; i++) {
        igi_element *back = &out->elements[out->count++];
        *back = out->elements[i];
        back->back = true;
        for (int k = 0; k < 3; k++) back->normal[k] = -back->normal[k];
    }
    for (size_t f = 0; f < out->facet_count; f++) out->facets[f].element[1] += (uint32_t)fronts;
}

igi_status igi_elements_create(igi_context *ctx, const igi_mesh *mesh, double size_m,
                               size_t max_count, bool both_sides, igi_elements **elements)
{
    igi_status status = IGI_OK;
    maker m = {.mesh = mesh};
    size_t sides = both_sides ? 2 : 1;
    *elements = NULL;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 1, &m.out));
    m.out->triangle_count = mesh->triangle_count;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, mesh->triangle_count, &m.small));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, mesh->triangle_count, &m.out->divisions));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, mesh->triangle_count, &m.out->first_facet));
    IGI_TRY_GOTO(plan_within(ctx, &m, size_m, max_count / sides));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, m.split_facets + m.small_count, &m.out->facets));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, sides * (m.split_facets + m.groups), &m.out->elements));
    for (size_t t = 0; t < mesh->triangle_count; t++)
        if (m.out->divisions[t] > 1) split_triangle(&m, t);
    merge_small(&m);
    if (both_sides) add_backs(m.out);
    *elements = m.out;
    m.out = NULL;
cleanup:
    igi_elements_destroy(m.out);
    igi_free(m.small);
    return status;
}

void igi_elements_destroy(igi_elements *elements)
{
    if (!elements) return;
    igi_free(elements->elements);
    igi_free(elements->facets);
    igi_free(elements->first_facet);
    igi_free(elements->divisions);
    igi_free(elements);
}

uint32_t igi_elements_at(const igi_elements *elements, uint32_t triangle, float u, float v,
                         bool back)
{
    int n = elements->divisions[triangle];
    if (n == 0) return IGI_NO_ELEMENT;
    size_t facet = elements->first_facet[triangle];
    if (n > 1) {
        float x = fmaxf(u, 0) * (float)n, y = fmaxf(v, 0) * (float)n;
        int j = y < (float)n ? (int)y : n - 1, i = x < (float)(n - j) ? (int)x : n - j - 1;
        bool upper = (x - (float)i) + (y - (float)j) > 1 && i < n - j - 1;
        facet += (size_t)(2 * n * j - j * j + 2 * i + (upper ? 1 : 0));
    }
    return elements->facets[facet].element[back ? 1 : 0];
}

igi_status igi_elements_keep(igi_context *ctx, igi_elements *elements, const bool *keep)
{
    uint32_t *number, count = 0;
    IGI_TRY(IGI_ALLOC(ctx, elements->count, &number));
    for (size_t i = 0; i < elements->count; i++) {
        number[i] = keep[i] ? count : IGI_NO_ELEMENT;
        if (keep[i]) elements->elements[count++] = elements->elements[i];
    }
    elements->count = count;
    for (size_t f = 0; f < elements->facet_count; f++) {
        uint32_t *side = elements->facets[f].element, to[2];
        for (int k = 0; k < 2; k++)
            to[k] = side[k] == IGI_NO_ELEMENT ? IGI_NO_ELEMENT : number[side[k]];
        for (int k = 0; k < 2; k++) side[k] = to[k] != IGI_NO_ELEMENT ? to[k] : to[1 - k];
    }
    igi_free(number);
    return IGI_OK;
}

const igi_facet *igi_elements_facet(const igi_elements *elements, uint32_t e, double choice)
{
    const igi_element *element = &elements->elements[e];
    const igi_facet *facets = elements->facets + element->first_facet;
    double wanted = choice * element->area;
    size_t low = 0, high = element->facet_count - 1;
    while (low < high) {
        size_t middle = (low + high) / 2;
        if (facets[middle].area_so_far > wanted) high = middle;
        else low = middle + 1;
    }
    return &facets[low];
}

double igi_facet_area(const igi_facet *facet)
{
    double normal[3];
    return 0.5 * find_normal(facet, normal);
}

void igi_facet_point(const igi_facet *facet, double u, double v, double margin, double point[3])
{
    double root = sqrt(u), weight[3] = {1 - root, root * (1 - v), root * v}, normal[3];
    /* The inscribed circle's radius is twice the area over the circumference. */
    double radius = find_normal(facet, normal) / (3 * longest_edge(facet));
    double shrink = 1 - fmin(margin / radius, 0.2);
    for (int k = 0; k < 3; k++) {
        point[k] = 0;
        for (int c = 0; c < 3; c++)
            point[k] += (1.0 / 3 + shrink * (weight[c] - 1.0 / 3)) * facet->corner[c][k];
    }
}
