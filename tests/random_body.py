"""Random cases of motion, for campaigns that compare two ways to compute them: random_case(rng).

Each has one to three blocks in any place, of random laws, damping, strength and yield, perhaps with contacts, capsules, a wall,
supports, loads, gravity and a second stage, for some hundred steps. One block may be periodic, in a cell of any shape
that moves by strain and stress."""


def vector(rng, size):
    return str([round(rng.uniform(-size, size), 6) for _ in range(3)])


def bonds(rng, name, approach=False, capsules=False):
    text = f'[[bonds]]\nname = "of_{name}"\nbetween = ["{name}", "{name}"]\ndistance = {rng.choice([1.1, 1.5, 1.8])}\n'
    few = "1.1" in text  # bonds: processes that work out all capsules of more take minutes
    text += 'when = "approach"\n' if approach else ""
    text += f'law = "{rng.choice(["v-model", "evm"])}"\n' if rng.random() < 0.3 else ""
    text += ("stiffness = {c_A = %.3g, c_D = %.3g, c_B = %.3g, c_T = %.3g}\n" %
             (rng.uniform(0.5, 2), rng.uniform(0.1, 0.6), rng.uniform(0.02, 0.1), rng.uniform(0.02, 0.1)))
    if capsules and few and rng.random() < 0.5:
        text += f"capsule_radius = {rng.uniform(0.1, 0.3):.3g}\n"
    if rng.random() < 0.4:
        text += f"damping = {{ratio = {rng.uniform(0.01, 0.2):.3g}}}\n"
    if rng.random() < 0.4:
        limit = rng.uniform(0.003, 0.05)
        text += ('strength = {criterion = "linear", axial_force = %.3g, shear_force = %.3g, bending_moment = %.3g, '
                 "torque = %.3g}\n" % (limit, limit, limit / 2, limit / 2))
    elif rng.random() < 0.3:
        text += f"yield = {{axial_force = {rng.uniform(1e-3, 1e-2):.3g}}}\n"
    return text


def cell(rng, cells):
    """Around a block of so many cells, tilted or not, with or without room across its faces, little or much."""
    tilt = rng.choice([0, 0.4])
    edges = [[cells[k] + rng.choice([0, 0, 0.3, 3]) if k == axis else round(rng.uniform(-tilt, tilt), 3)
              for k in range(3)] for axis in range(3)]
    text = "[cell]\n" + "".join(f"{name} = {edge}\n" for name, edge in zip("abc", edges))
    text += f"corner = {vector(rng, 1)}\n" if rng.random() < 0.5 else ""
    text += f'open = ["{rng.choice("abc")}"]\n' if tilt == 0 and rng.random() < 0.3 else ""
    return text + ('rotation = "triangular"\n' if rng.random() < 0.4 else "")


def moving_cell(rng, opened):
    free = [name for name in ["xx", "yy", "zz", "yz", "xz", "xy"] if opened not in name]
    text = "[stage.cell]\nservo = {modulus = 5.0, time = 2.0, fastest = 5e-3}\n"
    for component in rng.sample(free, rng.randint(1, len(free))):
        how = rng.choice([f"rate = {rng.uniform(-2e-3, 2e-3):.3g}", f"stress = {rng.uniform(-5e-3, 5e-3):.3g}"])
        text += f"{component} = {{{how}}}\n"
    return text


def stage(rng, name, groups, walled, opened):
    text = f'[[stage]]\nname = "{name}"\nduration = "{rng.uniform(1, 12):.2f} T0"\n'
    if rng.random() < 0.3:
        text += f"damping = {{translation = {rng.uniform(0, 0.01):.3g}, rotation = {rng.uniform(0, 1e-3):.3g}}}\n"
    if opened and rng.random() < 0.7:
        return text + moving_cell(rng, opened)
    if rng.random() < 0.3:
        text += f"gravity = {vector(rng, 1e-3)}\n"
    if rng.random() < 0.5:
        how = rng.choice(['fix = ["x", "rz"]', 'fix = ["x", "y", "z", "rx", "ry", "rz"], velocity = [1e-3, 0, 0]',
                          "rigid = true, velocity = [0, 2e-3, 0]"])
        text += f'supports = [{{group = "corner", {how}}}]\n'
    if rng.random() < 0.4:
        group = rng.choice(groups)
        text += f'loads = [{{group = "{group}", force = {vector(rng, 1e-3)}, moment = {vector(rng, 1e-4)}}}]\n'
    if walled and rng.random() < 0.5:
        text += 'walls = [{wall = "floor", velocity = [0, 0, 0.01]}]\n'
    return text


def random_case(rng, stages=None):
    blocks, contact = rng.randint(1, 3), rng.random() < 0.4
    periodic = rng.random() < 0.4
    if periodic:
        blocks = 1
    walled = contact and not periodic and rng.random() < 0.5
    opened = ""  # of a periodic body: the axis that it is open along
    names = [f"block_{k}" for k in range(blocks)]
    text = 'title = "random"\n'
    for k, name in enumerate(names):
        cells = [rng.randint(1, 7) for _ in range(3)]
        cells[rng.randrange(3)] += 2
        if periodic:
            text += (of_cell := cell(rng, cells))
            opened = "xyz"["abc".index(of_cell.split('open = ["')[1][0])] if "open" in of_cell else "none"
        origin = [round(rng.uniform(-3, 3), 3), round(rng.uniform(-3, 3), 3), 9.5 * k]
        text += (f'[[specimen]]\nname = "{name}"\nkind = "block"\ncells = {cells}\norigin = {origin}\n'
                 f"radius = {rng.choice([0.3, 0.4, 0.5])}\nmass = {rng.uniform(0.5, 2):.3g}\n")
    text += f"[groups]\ncorner = {{box = {{min = [-4, -4, -2], max = [4, 4, {1.5 if periodic else 0.5}]}}}}\n"
    approach = periodic and rng.random() < 0.4
    text += "".join(bonds(rng, name, approach, contact) for name in names)
    if contact:
        text += ('[contact]\nlaw = "hertz"\nE = 3.0\nnu = 0.3\npairs = "unbonded"\ntangential = "mindlin"\n'
                 f"friction = {rng.uniform(0, 0.6):.3g}\nrestitution = {rng.uniform(0.4, 1):.3g}\n")
    if walled:
        text += '[[wall]]\nname = "floor"\nshape = "plane"\npoint = [0, 0, -0.7]\nnormal = [0, 0, 1]\n'
    for name in names:
        text += (f'[[velocities]]\ngroup = "{name}"\nkind = "rigid"\nvelocity = {vector(rng, 0.1)}\n'
                 f"angular_velocity = {vector(rng, 0.08) if not periodic else [0, 0, 0]}\n")  # faces cut what turns
    text += f'[[velocities]]\ngroup = "all"\nkind = "gaussian"\nmagnitude = 1e-3\nseed = {rng.randint(1, 999)}\n'
    text += '[time]\nfraction = 0.1\n'
    stages = rng.randint(1, 2) if stages is None else stages
    text += "".join(stage(rng, f"stage_{k}", names, walled, opened) for k in range(stages))
    return text + ('[output.history]\nevery = "0.2 T0"\ndisplacements = ["block_0", 0]\nvelocities = ["block_0", "all"]\n'
                   'axial_force = ["block_0"]\nstress = [{group = "block_0", volume = 10.0}, {group = "all", volume = 20.0}]\n'
                   "[watch]\nevery = 20\n")
