// One query of every kind of `eval`.
#pragma once

namespace bb::fuzz {

inline constexpr const char* eval_lines[] = {
    R"({"id":1,"kind":"shape","shape":"cubic","argument":"squared_gap","d":0.5,"d_hat":1})",
    R"({"kind":"rho","shape":"log","u":0.25,"precision":"float"})",
    R"({"kind":"equilibrium","shape":"two_stage","kappa":1000,"d_hat":0.01,"load":1})",
    R"({"kind":"match","rule":"equal_force","shape":"quadratic","d_hat":0.01,"load":2,"theta":0.1})",
    R"({"kind":"match","rule":"equal_curvature","shape":"log_squared","d_hat":0.01,"curvature":2})",
    R"({"kind":"distance","pair":"point_triangle","points":[[0,0,1],[0,0,0],[1,0,0],[0,1,0]]})",
    R"({"kind":"distance","pair":"edge_edge","points":[[0,0,1],[1,0,1],[0,0,0],[0,1,0]],"precision":"float"})",
    R"({"kind":"ccd","pair":"point_edge","points_t0":[[0,1,0],[0,0,0],[1,0,0]],"points_t1":[[0,-1,0],[0,0,0],[1,0,0]],"offset":0,"park":1e-6})",
    R"({"kind":"intersects","segment":[[0,0,1],[0,0,-1]],"triangle":[[-1,-1,0],[1,-1,0],[0,1,0]]})",
    R"({"kind":"stiffness","policy":"elasticity_inclusive","mass_term":"inertia","dt":0.01,"c":1,"weights":[1,-1],"normal":[0,0,1],"gap":0.001,"masses":[1,2],"hessian":[[1,0,0,0,0,0],[0,1,0,0,0,0],[0,0,1,0,0,0],[0,0,0,1,0,0],[0,0,0,0,1,0],[0,0,0,0,0,1]]})",
    R"({"kind":"strain_limit","shape":"cubic","sigma":[1.01,1],"onset":0,"width":0.05})",
    R"({"kind":"strain_limit","shape":"log","F":[[1.02,0],[0,1],[0,0]],"onset":0.01,"width":0.05})",
    R"({"kind":"energy","model":"stvk","rest":[[0,0,0],[1,0,0],[0,1,0]],"x":[[0,0,0],[1.1,0,0],[0,1,0.2]],"parameters":{"lame_mu":2,"lame_lambda":3}})",
    R"({"kind":"energy","model":"hinge","rest":[[0,0,0],[1,0,0],[0,1,0],[0,-1,0]],"x":[[0,0,0],[1,0,0],[0,1,0.1],[0,-1,0]],"parameters":{"k":2,"rest_angle":0}})",
    R"({"kind":"svd","F":[[1,2],[3,4],[5,6]]})",
    R"({"kind":"condition","rows":[0,1,1,2],"cols":[0,0,1,2],"values":[2,-1,2,3],"scaling":"jacobi","tier":2})"};

}  // namespace bb::fuzz
