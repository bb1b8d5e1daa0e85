"""`bench engine`: scenes under engines that other people wrote, each before `bench judge`."""
