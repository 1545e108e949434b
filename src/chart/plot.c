/* SPDX-License-Identifier: Apache-2.0
 *
 * gnuplot is a program, not a library: it is run as a child, its words go to a file, and its
 * absence is not a failure.
 */
#include "chart/plot.h"

#include <errno.h>
#include <fcntl.h>
#include <spawn.h>
#include <string.h>
#include <sys/wait.h>

extern char **environ;

igi_status chart_table_begin(igi_context *ctx, const char *folder, const char *name,
                             const char *columns, igi_file *table)
{
    char *path = NULL;
    IGI_TRY(igi_strprintf(ctx, &path, "%s/%s", folder, name));
    igi_status status = igi_file_begin(ctx, path, table);
    igi_free(path);
    if (status == IGI_OK) fprintf(table->stream, "%s\n", columns);
    return status;
}

igi_status chart_plot_begin(igi_context *ctx, const char *folder, const char *name, int width,
                            int height, igi_file *script)
{
    static const char head[] = "set encoding utf8\n"
                               "set datafile separator ','\n"
                               "set datafile missing ''\n"
                               "set style line 100 lc rgb '#e4e4e4' lw 1\n"
                               "set grid ls 100\n"
                               "set border 3 lc rgb '#707070'\n"
                               "set tics nomirror out scale .5 textcolor rgb '#404040'\n"
                               "set linetype 1 lc rgb '#0072b2' lw 2 pt 7 ps .7\n"
                               "set linetype 2 lc rgb '#d55e00' lw 2 pt 5 ps .7\n"
                               "set linetype 3 lc rgb '#009e73' lw 2 pt 9 ps .8\n"
                               "set linetype 4 lc rgb '#cc79a7' lw 2 pt 11 ps .8\n"
                               "set linetype 5 lc rgb '#e69f00' lw 2 pt 13 ps .9\n"
                               "set linetype 6 lc rgb '#56b4e9' lw 2 pt 4 ps .7\n"
                               "set linetype 7 lc rgb '#808080' lw 2 pt 1 ps .7\n"
                               "set linetype 8 lc rgb '#000000' lw 2 pt 2 ps .7\n";
    char *path = NULL;
    IGI_TRY(igi_strprintf(ctx, &path, "%s/%s.gp", folder, name));
    igi_status status = igi_file_begin(ctx, path, script);
    igi_free(path);
    IGI_TRY(status);
    fprintf(script->stream, "# Draws %s.svg and %s.png: gnuplot %s.gp\n%s", name, name, name, head);
    fprintf(script->stream,
            "do for [picture in 'svg png'] {\n"
            "if (picture eq 'svg') { set terminal svg size %d,%d font 'DejaVu Sans,13' "
            "background '#ffffff' } else { set terminal pngcairo size %d,%d font "
            "'DejaVu Sans,10' }\n"
            "set output '%s.'.picture\n",
            width, height, width, height, name);
    return IGI_OK;
}

static void quote(FILE *script, const char *text, const char *mark_up)
{
    fputc('\'', script);
    for (; *text; text++) {
        if (strchr(mark_up, *text)) fputc('\\', script);
        if (*text == '\'') fputc('\'', script);
        fputc((unsigned char)*text >= ' ' ? *text : ' ', script);
    }
    fputc('\'', script);
}

void chart_plot_quoted(FILE *script, const char *text)
{
    quote(script, text, "");
}

void chart_plot_text(FILE *script, const char *text)
{
    quote(script, text, "_^{}@&~");
}

/* A child with its words in the file `words`; *started is false where there is no such program. */
static igi_status run(igi_context *ctx, char *const arguments[], const char *words, bool *started,
                      bool *done)
{
    posix_spawn_file_actions_t actions;
    pid_t child;
    int result = 0;
    *started = *done = false;
    if (posix_spawn_file_actions_init(&actions))
        return igi_fail(ctx, IGI_E_SYSTEM, "no memory for a child process");
    int wrong = posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
    if (!wrong)
        wrong = posix_spawn_file_actions_addopen(&actions, 1, words, O_WRONLY | O_CREAT | O_TRUNC,
                                                 0666);
    if (!wrong) wrong = posix_spawn_file_actions_adddup2(&actions, 1, 2);
    if (!wrong) wrong = posix_spawnp(&child, arguments[0], &actions, NULL, arguments, environ);
    posix_spawn_file_actions_destroy(&actions);
    if (wrong == ENOENT) return IGI_OK;
    if (wrong)
        return igi_fail(ctx, IGI_E_SYSTEM, "%s: cannot be run (%s)", arguments[0], strerror(wrong));
    while (waitpid(child, &result, 0) < 0 && errno == EINTR) continue;
    *started = !WIFEXITED(result) || WEXITSTATUS(result) != 127;
    *done = WIFEXITED(result) && WEXITSTATUS(result) == 0;
    return IGI_OK;
}

static void first_line(const char *path, char *line, int size)
{
    FILE *file = fopen(path, "r");
    line[0] = 0;
    while (file && fgets(line, size, file) && strspn(line, " ^\n") == strlen(line)) continue;
    line[strcspn(line, "\n")] = 0;
    if (file) fclose(file);
}

static igi_status draw(igi_context *ctx, const char *folder, const char *name)
{
    igi_status status = IGI_OK;
    char *enter = NULL, *script = NULL, *words = NULL, line[256];
    size_t at = 0, length = strlen(folder);
    bool started, done;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 2 * length + 8, &enter));
    IGI_TRY_GOTO(igi_strprintf(ctx, &script, "%s.gp", name));
    IGI_TRY_GOTO(igi_strprintf(ctx, &words, "%s/%s.words", folder, name));
    memcpy(enter, "cd '", 4);
    at = 4;
    for (size_t i = 0; i < length; i++) {
        if (folder[i] == '\'') enter[at++] = '\'';
        enter[at++] = folder[i];
    }
    enter[at] = '\'';
    char program[] = "gnuplot", option[] = "-e";
    char *const arguments[] = {program, option, enter, script, NULL};
    IGI_TRY_GOTO(run(ctx, arguments, words, &started, &done));
    first_line(words, line, sizeof line);
    remove(words);
    if (!started)
        igi_warn(ctx,
                 "gnuplot: not found, so that nothing is drawn; install it (Debian: "
                 "gnuplot-nox), then run gnuplot %s in the folder",
                 script);
    else if (!done) status = igi_fail(ctx, IGI_E_INTERNAL, "gnuplot: %s: %s", script, line);
cleanup:
    igi_free(enter);
    igi_free(script);
    igi_free(words);
    return status;
}

igi_status chart_plot_end(igi_context *ctx, const char *folder, const char *name, igi_file *script)
{
    fputs("unset output\n}\n", script->stream);
    IGI_TRY(igi_file_end(ctx, script, IGI_OK));
    return draw(ctx, folder, name);
}
