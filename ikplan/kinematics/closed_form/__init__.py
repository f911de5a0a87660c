"""All branches of arms whose inverse kinematics has a closed form."""
