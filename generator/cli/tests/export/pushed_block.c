/* Lets a block fall on a floor, and pushes it: by 5 N from 0.5 s on, by 15 N from 1 s on. Prints events, and where it is
   at 0.75 s and 1.5 s. */
#include "pushed_block_simulation.h"

#include <stdio.h>
#include <string.h>

#define OK PUSHED_BLOCK_OK

static int advance(pushed_block_simulation *motion, double until)
{
    pushed_block_event event;
    pushed_block_coordinates q;
    pushed_block_speeds u;
    double floor[3], wall[3];
    int progress;

    while ((progress = pushed_block_simulation_advance(motion, until, &event)) == PUSHED_BLOCK_AT_EVENT)
        printf("event %.17g %d %d\n", event.time, (int)event.kind, (int)event.contact);
    if (progress != PUSHED_BLOCK_REACHED || pushed_block_simulation_state(motion, &q, &u) != OK)
        return 0;
    if (pushed_block_simulation_force(motion, PUSHED_BLOCK_CONTACT_FLOOR, floor) != OK || pushed_block_simulation_force(motion, PUSHED_BLOCK_CONTACT_WALL, wall) != OK)
        return 0;
    printf("at %.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g\n", pushed_block_simulation_time(motion), q.x, q.z, u.ux, u.uz, floor[0], floor[1], floor[2], wall[0]);
    return 1;
}

int main(void)
{
    pushed_block block;
    pushed_block_parameters parameters;
    pushed_block_coordinates q;
    pushed_block_speeds u;
    pushed_block_inputs inputs, none;
    pushed_block_surface surfaces[2] = {{0.5, 0, PUSHED_BLOCK_NEWTON}, {0.2, 0.5, PUSHED_BLOCK_POISSON}};
    pushed_block_closed_contact closed;
    pushed_block_collision hit;
    pushed_block_simulation *motion;

    if (pushed_block_default_parameters(&parameters) != OK || pushed_block_new(&parameters, &block) != OK)
        return 1;
    if (pushed_block_default_coordinates(&q) != OK || pushed_block_default_speeds(&u) != OK || pushed_block_default_inputs(&inputs) != OK)
        return 2;
    if (pushed_block_simulation_new(&block, 0, &q, &u, &inputs, 1e-12, surfaces, &motion) != OK || !advance(motion, 0.5))
        return 3;
    inputs.push = 5;
    if (pushed_block_simulation_set_inputs(motion, &inputs) != OK || !advance(motion, 0.75))
        return 4;
    /* Inputs that are no numbers are refused, and nothing changes. */
    none.push = 0.0 / 0.0;
    if (pushed_block_simulation_set_inputs(motion, &none) != PUSHED_BLOCK_REFUSED || strstr(pushed_block_simulation_message(motion), "push") == NULL)
        return 5;
    if (pushed_block_simulation_set_inputs(motion, NULL) != PUSHED_BLOCK_NULL || pushed_block_simulation_set_inputs(NULL, &inputs) != PUSHED_BLOCK_NULL)
        return 6;
    if (!advance(motion, 1))
        return 7;
    inputs.push = 15;
    if (pushed_block_simulation_set_inputs(motion, &inputs) != OK || !advance(motion, 1.5))
        return 8;
    pushed_block_simulation_free(motion);

    /* The modes of the floor alone: it holds 5 N and not 15 N. */
    inputs.push = 5;
    q.z = 0;
    if (pushed_block_contact_mode_floor(&block, &q, &u, &inputs, surfaces, &closed) != OK || closed.mode != PUSHED_BLOCK_STICK || closed.selection != PUSHED_BLOCK_UNIQUE)
        return 9;
    printf("margins %.17g %.17g %.17g %.17g\n", closed.margins.lambda_n, closed.margins.f, closed.margins.cone, closed.margins.s);
    u.ux = 0.25;
    if (pushed_block_contact_mode_floor(&block, &q, &u, &inputs, surfaces, &closed) != OK || closed.mode != PUSHED_BLOCK_SLIDE)
        return 10;
    printf("margins %.17g %.17g %.17g %.17g\n", closed.margins.lambda_n, closed.margins.f, closed.margins.cone, closed.margins.s);

    u.ux = 0;
    u.uz = -1;
    if (pushed_block_collide_floor(&block, &q, &u, surfaces, &hit) != OK)
        return 11;
    printf("impact %.17g %.17g %.17g %d %d %d %d %d %d\n", hit.impact.contact_work, hit.impact.normal_work, hit.impact.energy_gained, (int)hit.impact.compressions,
        (int)hit.impact.near_mu_c, (int)hit.impact.grazing, (int)hit.impact.unstable_direction, (int)hit.impact.no_slip, (int)hit.impact.jam);
    return 0;
}
