/* SPDX-License-Identifier: Apache-2.0
 *
 * Assimp in a child process with limits: whatever a damaged file makes it do, the caller gets a
 * sentence. The child sends its builder through a pipe: status, message, counts, arrays, names.
 */
#include "scene/mesh_builder.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define HAS_ADDRESS_SANITIZER 1
#endif
#elif defined(__SANITIZE_ADDRESS__)
#define HAS_ADDRESS_SANITIZER 1
#endif

typedef struct mesh_message {
    igi_status status;
    char sentence[1024];
    size_t vertex_count, uv_count, face_count, region_count;
    size_t name_bytes; /* all regions' names, each with its NUL */
} mesh_message;

/* ---- in the child ---- */

static bool send_all(int out, const void *bytes, size_t size)
{
    const char *at = bytes;
    while (size > 0) {
        ssize_t sent = write(out, at, size);
        if (sent < 0 && errno == EINTR) continue;
        if (sent <= 0) return false;
        at += sent;
        size -= (size_t)sent;
    }
    return true;
}

static void limit(int what, rlim_t most)
{
    struct rlimit now;
    if (getrlimit(what, &now) != 0) return;
    if (now.rlim_max == RLIM_INFINITY || now.rlim_max > most) now.rlim_max = most;
    now.rlim_cur = now.rlim_max;
    (void)setrlimit(what, &now);
}

static rlim_t seconds_for(off_t size)
{
    return 3 + (rlim_t)(size >> 20); /* a megabyte takes some tenth of a second */
}

static void prepare_child(off_t size)
{
    static const int signals[] = {SIGINT, SIGTERM, SIGPIPE, SIGABRT, SIGSEGV};
    for (size_t i = 0; i < sizeof signals / sizeof signals[0]; i++)
        (void)signal(signals[i], SIG_DFL); /* the caller's handlers are not for this process */
    int nowhere = open("/dev/null", O_WRONLY);
    if (nowhere >= 0) (void)dup2(nowhere, STDERR_FILENO); /* a crash's last words */
    limit(RLIMIT_CPU, seconds_for(size));
    limit(RLIMIT_CORE, 0);
#ifndef HAS_ADDRESS_SANITIZER /* which maps terabytes of shadow */
    limit(RLIMIT_AS, ((rlim_t)4 << 30) + 64 * (rlim_t)size);
#endif
}

static void run_child(igi_mesh_builder *b, off_t size, int out)
{
    mesh_message head = {.status = IGI_OK};
    prepare_child(size);
    head.status = igi_assimp_import(b);
    snprintf(head.sentence, sizeof head.sentence, "%s", igi_context_message(b->ctx));
    if (head.status == IGI_OK) {
        head.vertex_count = b->vertex_count;
        head.uv_count = b->uv_count;
        head.face_count = b->face_count;
        head.region_count = b->region_count;
        for (size_t i = 0; i < b->region_count; i++) head.name_bytes += strlen(b->regions[i]) + 1;
    }
    bool sent = send_all(out, &head, sizeof head);
    if (head.status == IGI_OK && sent) {
        sent = send_all(out, b->positions, 3 * b->vertex_count * sizeof *b->positions) &&
               send_all(out, b->uvs, 2 * b->uv_count * sizeof *b->uvs) &&
               send_all(out, b->faces, b->face_count * sizeof *b->faces);
        for (size_t i = 0; i < b->region_count && sent; i++)
            sent = send_all(out, b->regions[i], strlen(b->regions[i]) + 1);
    }
    _exit(sent ? 0 : 1); /* neither the caller's exit handlers nor its buffers */
}

/* ---- in the parent ---- */

/* IGI_E_DATA without a sentence when the child stops before all is said. */
static igi_status receive_all(igi_context *ctx, int in, void *bytes, size_t size)
{
    char *at = bytes;
    while (size > 0) {
        struct pollfd ready = {.fd = in, .events = POLLIN};
        IGI_TRY(igi_progress(ctx, 0));
        if (poll(&ready, 1, 100) <= 0) continue; /* a tenth of a second, or a signal */
        ssize_t got = read(in, at, size);
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) return IGI_E_DATA;
        at += got;
        size -= (size_t)got;
    }
    return IGI_OK;
}

static igi_status receive_regions(igi_mesh_builder *b, int in, const mesh_message *head)
{
    char *names;
    IGI_TRY(IGI_ALLOC(b->ctx, head->name_bytes + 1, &names)); /* ends with a NUL of its own */
    igi_status status = receive_all(b->ctx, in, names, head->name_bytes);
    const char *at = names;
    for (size_t i = 0; i < head->region_count && status == IGI_OK; i++) {
        uint32_t region;
        if (at >= names + head->name_bytes) break; /* check_indices says the rest */
        status = igi_mesh_builder_region(b, at, strlen(at), 0, &region);
        at += strlen(at) + 1;
    }
    igi_free(names);
    return status;
}

static igi_status receive(igi_mesh_builder *b, int in)
{
    mesh_message head;
    IGI_TRY(receive_all(b->ctx, in, &head, sizeof head));
    if (head.status != IGI_OK) return igi_fail(b->ctx, head.status, "%s", head.sentence);
    if ((head.vertex_count | head.uv_count | head.face_count | head.name_bytes) > UINT32_MAX)
        return igi_fail(b->ctx, IGI_E_DATA, "%s: larger than igi reads; take it apart", b->file);
    IGI_TRY(IGI_ALLOC(b->ctx, 3 * head.vertex_count, &b->positions));
    IGI_TRY(IGI_ALLOC(b->ctx, 2 * head.uv_count, &b->uvs));
    IGI_TRY(IGI_ALLOC(b->ctx, head.face_count, &b->faces));
    b->vertex_count = b->vertex_capacity = head.vertex_count;
    b->uv_count = b->uv_capacity = head.uv_count;
    b->face_count = b->face_capacity = head.face_count;
    IGI_TRY(receive_all(b->ctx, in, b->positions, 3 * b->vertex_count * sizeof *b->positions));
    IGI_TRY(receive_all(b->ctx, in, b->uvs, 2 * b->uv_count * sizeof *b->uvs));
    IGI_TRY(receive_all(b->ctx, in, b->faces, b->face_count * sizeof *b->faces));
    return receive_regions(b, in, &head);
}

static igi_status say_how_it_ended(igi_mesh_builder *b, int ended, off_t size)
{
    if (WIFSIGNALED(ended) && (WTERMSIG(ended) == SIGXCPU || WTERMSIG(ended) == SIGKILL))
        return igi_fail(b->ctx, IGI_E_DATA,
                        "%s: no mesh after %lu s, so it is probably damaged; write it again, or as "
                        "OBJ",
                        b->file, (unsigned long)seconds_for(size));
    return igi_fail(b->ctx, IGI_E_DATA,
                    "%s: damaged: its reader, Assimp, broke down; write it again, or as OBJ",
                    b->file);
}

igi_status igi_assimp_read(igi_mesh_builder *b)
{
    struct stat info;
    int ends[2], ended = 0;
    if (!igi_file_exists(b->file) || stat(b->file, &info) != 0)
        return igi_fail(b->ctx, IGI_E_DATA, "%s: no such file, or not readable", b->file);
    if (pipe(ends) != 0)
        return igi_fail(b->ctx, IGI_E_SYSTEM, "%s: no pipe: %s", b->file, strerror(errno));
    pid_t child = fork();
    if (child == 0) {
        close(ends[0]);
        run_child(b, info.st_size, ends[1]);
    }
    close(ends[1]);
    if (child < 0) {
        close(ends[0]);
        return igi_fail(b->ctx, IGI_E_SYSTEM, "%s: no process: %s", b->file, strerror(errno));
    }
    igi_status status = receive(b, ends[0]);
    close(ends[0]);
    if (status != IGI_OK && status != IGI_E_DATA) (void)kill(child, SIGKILL); /* it may run on */
    while (waitpid(child, &ended, 0) < 0 && errno == EINTR) continue;
    bool broke = !WIFEXITED(ended) || WEXITSTATUS(ended) != 0;
    if (status == IGI_E_DATA && broke) return say_how_it_ended(b, ended, info.st_size);
    return status;
}
