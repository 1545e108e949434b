/* SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "base/rng.h"
#include "rooms.h"
#include "transport/mesh_elements.h"

static igi_elements *make(igi_context *ctx, const room *r, double size, bool both)
{
    igi_elements *e = NULL;
    CHECK_OK(ctx, igi_elements_create(ctx, &r->mesh, size, 4000, both, &e));
    return e;
}

static double total_area(const igi_elements *e)
{
    double sum = 0;
    for (size_t i = 0; i < e->count; i++) sum += e->elements[i].area;
    return sum;
}

static void splits_large_triangles(void)
{
    igi_context *ctx = test_context(1);
    room *r = room_new();
    room_cube(r, 2, 1);
    igi_elements *e = make(ctx, r, 0.5, false);
    CHECK(e->count == 12 * 9); /* sqrt(2)/.5 -> 3 along an edge */
    CHECK(e->facet_count == e->count);
    CHECK_NEAR(total_area(e), 24, 1e-12);
    /* The facet that igi_elements_at finds contains the point. */
    igi_rng rng = igi_rng_make(1, 1);
    for (int k = 0; k < 2000; k++) {
        uint32_t t = igi_rng_next(&rng) % 12;
        float u = igi_rng_float(&rng), v = igi_rng_float(&rng);
        if (u + v > 1) u = 1 - u, v = 1 - v;
        igi_vec p = igi_triangle_point(&r->mesh, t, u, v);
        uint32_t i = igi_elements_at(e, t, u, v, k % 2);
        const igi_facet *f = &e->facets[e->elements[i].first_facet];
        CHECK(f->triangle == t);
        double sum = 0; /* the three triangles about the point make up the facet */
        for (int c = 0; c < 3; c++) {
            igi_vec a = igi_sub(igi_v_ofd(f->corner[c]), p),
                    b = igi_sub(igi_v_ofd(f->corner[(c + 1) % 3]), p);
            sum += 0.5 * (double)igi_length(igi_cross(a, b));
        }
        CHECK_NEAR(sum, e->elements[i].area, 1e-5);
    }
    igi_elements_destroy(e);
    free(r);
    igi_context_destroy(ctx);
}

static void merges_small_triangles(void)
{
    igi_context *ctx = test_context(1);
    room *r = room_new();
    room_cube(r, 1, 8);
    igi_elements *e = make(ctx, r, 2, false);
    CHECK(e->count == 6);
    for (size_t i = 0; i < e->count; i++) {
        CHECK_NEAR(e->elements[i].area, 1, 1e-6);
        CHECK(e->elements[i].facet_count == 128);
        CHECK(e->elements[i].region == i);
    }
    CHECK_NEAR(e->elements[0].normal[2], 1, 1e-12);
    CHECK_NEAR(e->elements[0].centre[0], .5, 1e-7);
    for (uint32_t t = 0; t < 768; t++)
        CHECK(igi_elements_at(e, t, .2f, .3f, false) == r->regions[t]);
    /* Facets are chosen in proportion to their area, and points lie within. */
    const igi_facet *first = &e->facets[e->elements[2].first_facet];
    CHECK(igi_elements_facet(e, 2, 0) == first);
    CHECK(igi_elements_facet(e, 2, 0.9999999) == first + 127);
    CHECK(igi_elements_facet(e, 2, 3.5 / 128) == first + 3);
    double p[3];
    igi_facet_point(first, 0, .5, 1e-3, p);
    CHECK(fabs(p[1] - first->corner[0][1]) + fabs(p[2] - first->corner[0][2]) > 1e-3);
    igi_elements_destroy(e);
    free(r);
    igi_context_destroy(ctx);
}

static void obeys_the_limit(void)
{
    igi_context *ctx = test_context(1);
    room *r = room_new();
    room_cube(r, 1, 4);
    igi_elements *e = NULL;
    CHECK_OK(ctx, igi_elements_create(ctx, &r->mesh, 1e-9, 500, true, &e));
    CHECK(e && e->count <= 500 && e->count >= 100);
    igi_elements_destroy(e);
    CHECK(igi_elements_create(ctx, &r->mesh, 1, 5, false, &e) == IGI_E_DATA);
    CHECK(e == NULL);
    CHECK_CONTAINS(igi_context_message(ctx), "more than 5 pieces");
    free(r);
    igi_context_destroy(ctx);
}

static void has_two_sides(void)
{
    igi_context *ctx = test_context(1);
    room *r = room_new();
    room_cube(r, 1, 1);
    igi_elements *e = make(ctx, r, 2, true);
    CHECK(e->count == 12);
    uint32_t front = igi_elements_at(e, 0, .1f, .1f, false),
             back = igi_elements_at(e, 0, .1f, .1f, true);
    CHECK(back == front + 6 && e->elements[back].back);
    CHECK_NEAR(e->elements[back].normal[2], -1, 1e-12);
    /* Of the floor only the back stays, of the ceiling nothing. */
    bool keep[12];
    for (int i = 0; i < 12; i++) keep[i] = i != 0 && i != 1 && i != 7;
    CHECK_OK(ctx, igi_elements_keep(ctx, e, keep));
    CHECK(e->count == 9);
    CHECK(igi_elements_at(e, 0, .1f, .1f, false) == igi_elements_at(e, 0, .1f, .1f, true));
    CHECK(e->elements[igi_elements_at(e, 0, .1f, .1f, false)].back);
    CHECK(igi_elements_at(e, 2, .1f, .1f, false) == IGI_NO_ELEMENT);
    CHECK(igi_elements_at(e, 4, .1f, .1f, false) == 0);
    igi_elements_destroy(e);
    free(r);
    igi_context_destroy(ctx);
}

static void survives_bad_triangles(void)
{
    igi_context *ctx = test_context(1);
    room *r = room_new();
    uint32_t a = room_vertex(r, 0, 0, 0), b = room_vertex(r, 1, 0, 0), c = room_vertex(r, 2, 0, 0);
    room_triangle(r, a, b, c, 0);
    room_triangle(r, a, a, a, 0);
    igi_elements *e = NULL;
    CHECK(igi_elements_create(ctx, &r->mesh, 1, 100, false, &e) == IGI_E_DATA);
    CHECK(e == NULL);
    CHECK_CONTAINS(igi_context_message(ctx), "no triangle has area");
    uint32_t far = room_vertex(r, HUGE_VAL, 0, 0), bad = room_vertex(r, 0, (double)NAN, 1);
    room_triangle(r, a, b, far, 0);
    room_triangle(r, a, b, bad, 0);
    uint32_t d = room_vertex(r, 0, 1, 0);
    room_triangle(r, a, b, d, 0);
    e = make(ctx, r, 10, true);
    CHECK(e->count == 2);
    CHECK(igi_elements_at(e, 0, .3f, .3f, false) == IGI_NO_ELEMENT);
    CHECK(igi_elements_at(e, 4, .3f, .3f, true) == 1);
    igi_elements_destroy(e);
    for (long n = 0; n < 6; n++) { /* out of memory, wherever it strikes */
        igi_fail_allocation_after(ctx, n);
        CHECK(igi_elements_create(ctx, &r->mesh, 1, 100, false, &e) == IGI_E_SYSTEM);
        CHECK(e == NULL);
    }
    igi_fail_allocation_after(ctx, -1);
    free(r);
    igi_context_destroy(ctx);
}

/* Soups of triangles of any size and place: every facet is found again, and areas add up. */
static void random_soups(void)
{
    igi_context *ctx = test_context(1);
    igi_rng rng = igi_rng_make(9, 9);
    for (int trial = 0; trial < 300; trial++) {
        room *r = room_new();
        int count = 1 + (int)(igi_rng_next(&rng) % 30);
        for (int t = 0; t < count; t++) {
            uint32_t id[3];
            double size = pow(10, -6 + 12 * (double)igi_rng_float(&rng));
            for (int c = 0; c < 3; c++) {
                double x = (double)igi_rng_float(&rng), y = (double)igi_rng_float(&rng);
                id[c] = room_vertex(r, size * x, size * y, trial % 3 == 0 ? 0 : size * (x - y * y));
            }
            if (igi_rng_next(&rng) % 8 == 0) id[2] = id[1];
            room_triangle(r, id[0], id[1], id[2], igi_rng_next(&rng) % 3);
        }
        igi_elements *e = NULL;
        igi_status status = igi_elements_create(ctx, &r->mesh, 1e-3, 600, trial % 2, &e);
        CHECK(status == IGI_OK || (status == IGI_E_DATA && !e));
        for (uint32_t t = 0; e && t < r->mesh.triangle_count; t++)
            for (int k = 0; k < 20; k++) {
                float u = igi_rng_float(&rng), v = igi_rng_float(&rng) * (1 - u);
                uint32_t i = igi_elements_at(e, t, u, v, k % 2);
                CHECK((i == IGI_NO_ELEMENT) == (e->divisions[t] == 0));
                if (i == IGI_NO_ELEMENT) continue;
                CHECK(i < e->count && e->elements[i].region == r->regions[t]);
                const igi_facet *f = igi_elements_facet(e, i, (double)u);
                CHECK(f >= e->facets + e->elements[i].first_facet &&
                      f < e->facets + e->elements[i].first_facet + e->elements[i].facet_count);
                CHECK(e->elements[i].area > 0 && isfinite(e->elements[i].centre[0]));
            }
        igi_elements_destroy(e);
        free(r);
    }
    igi_context_destroy(ctx);
}

TEST_MAIN({"random_soups", random_soups}, {"splits_large_triangles", splits_large_triangles},
          {"merges_small_triangles", merges_small_triangles}, {"obeys_the_limit", obeys_the_limit},
          {"has_two_sides", has_two_sides}, {"survives_bad_triangles", survives_bad_triangles})
