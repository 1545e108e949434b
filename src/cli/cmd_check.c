/* SPDX-License-Identifier: Apache-2.0
 *
 * igi check: what the photographs of a scene can determine, as tables or as JSON.
 */
#include "cli.h"

#include <math.h>

static void print_key(const char *key, double x)
{
    printf(", \"%s\": ", key);
    cli_print_json_number(x);
}

static void print_text(const char *key, const char *text)
{
    printf(", \"%s\": ", key);
    if (text) cli_print_json_string(text);
    else fputs("null", stdout);
}

static void print_numbers(const char *key, const double *x, int count)
{
    printf(", \"%s\": [", key);
    for (int i = 0; i < count; i++) {
        if (i) fputs(", ", stdout);
        cli_print_json_number(x[i]);
    }
    putchar(']');
}

static void print_assumption_json(const igi_check *check, const igi_assumption *a)
{
    printf("{\"name\": \"%s\", \"verdict\": \"%s\"", a->name, igi_verdict_name(a->verdict));
    print_key("number", a->number);
    print_text("finding", a->finding);
    print_text("remedy", a->remedy);
    if (a->region >= 0) print_text("region", check->regions[a->region].name);
    if (a->frame >= 0) print_text("image", check->photos[a->frame].name);
    if (a->has_view) {
        print_numbers("eye", a->eye, 3);
        print_numbers("target", a->target, 3);
    }
    putchar('}');
}

static void print_region_json(const igi_region_check *r, int bands)
{
    cli_print_json_string(r->name);
    printf(": {\"emitter\": %s, \"views\": %d", r->emitter ? "true" : "false", r->views);
    print_key("area", r->area);
    print_key("observed", r->observed);
    print_key("seen_once", r->seen_once);
    print_key("angle_low_deg", r->angle_low_deg);
    print_key("angle_high_deg", r->angle_high_deg);
    print_key("unseen", r->unseen);
    print_key("escaped", r->escaped);
    printf(", \"highlights_predicted\": %d, \"highlights_seen\": %d", r->highlights_predicted,
           r->highlights_seen);
    print_numbers("albedo", r->albedo, bands);
    putchar('}');
}

static void print_photo_json(const igi_photo_check *p)
{
    cli_print_json_string(p->name);
    printf(": {\"left_out\": %s, \"scaled\": %s, \"edges\": %zu", p->left_out ? "true" : "false",
           p->scaled ? "true" : "false", p->edges);
    print_key("gain", p->gain);
    print_key("gain_error", p->gain_error);
    print_key("contradicts", p->contradicts);
    print_key("saturated", p->saturated);
    print_numbers("offset_px", p->offset, 2);
    print_key("offset_error_px", p->offset_error);
    putchar('}');
}

static void print_json(const igi_scene *scene, const igi_check *check)
{
    printf("{\"igi\": 1, \"scene\": ");
    cli_print_json_string(scene->name);
    printf(", \"verdict\": \"%s\",\n \"assumptions\": [", igi_verdict_name(check->verdict));
    for (size_t i = 0; i < check->assumption_count; i++) {
        fputs(i ? ",\n  " : "\n  ", stdout);
        print_assumption_json(check, &check->assumptions[i]);
    }
    fputs("],\n \"regions\": {", stdout);
    for (size_t i = 0; i < check->region_count; i++) {
        fputs(i ? ",\n  " : "\n  ", stdout);
        print_region_json(&check->regions[i], scene->bands);
    }
    fputs("},\n \"lights\": [", stdout);
    for (size_t i = 0; i < check->light_count; i++) {
        const igi_light_check *l = &check->lights[i];
        fputs(i ? ", {\"name\": " : "{\"name\": ", stdout);
        cli_print_json_string(l->name);
        printf(", \"known\": %s, \"seen\": %s}", l->known ? "true" : "false",
               l->seen ? "true" : "false");
    }
    fputs("],\n \"photographs\": {", stdout);
    for (size_t i = 0; i < check->photo_count; i++) {
        fputs(i ? ",\n  " : "\n  ", stdout);
        print_photo_json(&check->photos[i]);
    }
    fputs("},\n \"mesh\": {\"unseen_area\": ", stdout);
    cli_print_json_number(check->unseen_area);
    print_key("amplification", check->amplification);
    print_key("unseen_condition", check->unseen_condition);
    printf(", \"doubled_faces\": %zu, \"flipped_edges\": %zu},\n \"warnings\": [",
           check->doubled_faces, check->flipped_edges);
    for (size_t i = 0; i < check->warning_count; i++) {
        fputs(i ? ", " : "", stdout);
        cli_print_json_string(check->warnings[i]);
    }
    puts("]}");
}

/* A sentence over lines of at most some 84 characters. */
static void print_wrapped(const char *text, int indent)
{
    int column = 0;
    while (*text) {
        int word = 0;
        while (text[word] && text[word] != ' ') word++;
        if (column > 0 && column + 1 + word > 84) {
            printf("\n%*s", indent, "");
            column = 0;
        } else if (column > 0) {
            putchar(' ');
            column++;
        }
        printf("%.*s", word, text);
        column += word;
        text += word;
        while (*text == ' ') text++;
    }
    putchar('\n');
}

static void print_assumptions(const igi_check *check)
{
    for (size_t i = 0; i < check->assumption_count; i++) {
        const igi_assumption *a = &check->assumptions[i];
        cli_print_padded(a->name, 13);
        cli_print_padded(igi_verdict_name(a->verdict), 9);
        print_wrapped(a->finding, 22);
        if (!a->remedy) continue;
        printf("%*s-> ", 19, "");
        print_wrapped(a->remedy, 22);
    }
}

static void print_regions(const igi_check *check)
{
    int width = 6;
    for (size_t i = 0; i < check->region_count; i++) {
        int w = cli_text_width(check->regions[i].name);
        if (w > width) width = w;
    }
    puts("");
    cli_print_padded("region", width);
    puts("  observed  views  angles, deg  faces unseen  highlights seen of predicted");
    for (size_t i = 0; i < check->region_count; i++) {
        const igi_region_check *r = &check->regions[i];
        if (r->emitter) continue;
        cli_print_padded(r->name, width);
        printf("  %6.1f %%  %5d", 100 * r->observed, r->views);
        if (isfinite(r->angle_low_deg))
            printf("  %7.0f..%2.0f", r->angle_low_deg, r->angle_high_deg);
        else printf("  %11s", "-");
        if (isfinite(r->unseen)) printf("  %10.1f %%", 100 * r->unseen);
        else printf("  %12s", "-");
        printf("  %15d of %d\n", r->highlights_seen, r->highlights_predicted);
    }
}

static void print_verdict(const igi_scene *scene, const igi_check *check)
{
    static const char *const words[] = {
        "all that recovery assumes holds", "recovery will run; its doubts are named above",
        "recovery has no answer to this, or a wrong one; see what fails above"};
    printf("\n%s: %s\n", scene->name, words[check->verdict]);
}

static igi_status save_manifest(cli_session *s, const igi_scene *scene, const char *folder)
{
    char command[4096], text[8][32];
    igi_setting settings[8];
    cli_command_line(s, command, sizeof command);
    igi_manifest manifest = {.command = command,
                             .setting_count = cli_settings(s, settings, text, 8),
                             .settings = settings,
                             .input_count = scene->file_count,
                             .inputs = (const char *const *)scene->files};
    return igi_manifest_save(s->context, &manifest, folder);
}

/* With -o, the page in a folder of its own. */
static igi_status look(cli_session *s, const igi_scene *scene, igi_check **check)
{
    igi_output *output = NULL;
    if (!s->values.output) return igi_check_scene(s->context, scene, check);
    igi_status status = igi_output_begin(s->context, s->values.output, s->values.force,
                                         s->arguments[0], &output);
    if (status == IGI_OK)
        status = igi_check_page(s->context, scene, igi_output_folder(output), check);
    if (status == IGI_OK) status = save_manifest(s, scene, igi_output_folder(output));
    if (status == IGI_OK) status = igi_output_commit(s->context, output);
    igi_output_destroy(output);
    return status;
}

static igi_status run(cli_session *s)
{
    igi_scene *scene = NULL;
    igi_check *check = NULL;
    cli_progress_report(s, "scene", 0);
    igi_status status = igi_scene_load(s->context, s->arguments[0], &scene);
    if (status == IGI_OK) status = look(s, scene, &check);
    cli_progress_clear(&s->progress);
    if (status == IGI_OK && s->values.json) {
        print_json(scene, check);
    } else if (status == IGI_OK && !s->values.quiet) {
        print_assumptions(check);
        print_regions(check);
        print_verdict(scene, check);
        if (s->values.output) printf("%s/check.html: written\n", s->values.output);
    }
    if (status == IGI_OK && check->verdict == IGI_FAILS) {
        status = IGI_E_NO_ANSWER;
        for (size_t i = 0; i < check->assumption_count; i++)
            if (check->assumptions[i].verdict == IGI_FAILS)
                fprintf(stderr, "igi: %s: %s; %s\n", s->arguments[0], check->assumptions[i].finding,
                        check->assumptions[i].remedy);
    }
    igi_check_destroy(check);
    igi_scene_destroy(scene);
    return status;
}

const cli_command cli_check = {
    .name = "check",
    .bit = CLI_CHECK,
    .arguments = 1,
    .usage = "check SCENE [-o DIR] [--json]",
    .summary = "what the photographs allow, which assumption fails, what to do",
    .example = "igi check my-room",
    .details =
        "Takes about a second. Each assumption of recovery holds, is doubtful (recovery runs,\n"
        "and warns), or fails (exit status 1), with the number behind it and a remedy: often\n"
        "the place to take another photograph from. Of each region: the share that photographs\n"
        "show, how many do, their angles from its normal, the share of what it faces that none\n"
        "shows, and at how many places a lamp is mirrored toward a camera. With -o, "
        "DIR/check.html\n"
        "is all of it with pictures: the mesh coloured by what is photographed, marks on the\n"
        "photographs, and the views from the places to take another one from.",
    .run = run,
};
